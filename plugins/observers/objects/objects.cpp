// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <cstdio>
#include <filesystem>
#include <string>

#include "holdfast/core/trajectory.hpp"
#include "holdfast/interfaces/observer.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/objects.hpp"

namespace holdfast {

void ObjectsSettings::describe(ParameterTable<ObjectsSettings>& table) {
  table.add("hidden", &ObjectsSettings::hidden, "also write the predicted poses of occluded objects");
}

namespace {

/// Writes what moves to objects.csv at the end of a run. Needs an output folder, and does nothing without one.
class Objects final : public Observer {
 public:
  Objects(const ObjectsSettings& settings, const CreationContext& context)
      : settings_(settings), folder_(context.output_directory) {}

  void on_frame(const SensorFrame&, const Frame&, const FrameResult& result) override {
    if (folder_.empty()) return;
    for (const MovingObject& object : result.objects)
      if (settings_.hidden || object.last_seen >= result.timestamp) write(result.timestamp, object);
  }
  void on_finish(const Map&) override {
    if (!folder_.empty()) write_file_atomically(folder_ / "objects.csv", text_);
  }

 private:
  void write(double timestamp, const MovingObject& object) {
    const Eigen::Vector3d place = object.T_world_object.translation();
    const Eigen::Quaterniond turn(object.T_world_object.linear());
    const Eigen::Vector3f low = object.box.min(), high = object.box.max();
    char line[512];
    std::snprintf(line, sizeof(line), "%.6f,%u,%s,%d,%.4f,%.4f,%.4f,%.5f,%.5f,%.5f,%.5f,%.4f,%.4f,%.4f,", timestamp,
                  object.id, object.class_name.substr(0, 100).c_str(), object.moving ? 1 : 0, place.x(), place.y(),
                  place.z(), turn.x(), turn.y(), turn.z(), turn.w(), object.velocity.x(), object.velocity.y(),
                  object.velocity.z());
    text_ += line;
    std::snprintf(line, sizeof(line), "%.4f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.6f\n",
                  static_cast<double>(object.speed_deviation), static_cast<double>(low.x()),
                  static_cast<double>(low.y()), static_cast<double>(low.z()), static_cast<double>(high.x()),
                  static_cast<double>(high.y()), static_cast<double>(high.z()), object.last_seen);
    text_ += line;
  }

  ObjectsSettings settings_;
  std::filesystem::path folder_;
  std::string text_ =
      "timestamp,id,class,moving,x,y,z,qx,qy,qz,qw,vx,vy,vz,speed_deviation,box_min_x,box_min_y,box_min_z,box_max_x,"
      "box_max_y,box_max_z,last_seen\n";
};

}  // namespace

HOLDFAST_PLUGIN(objects, registry) {
  registry.add<Observer, Objects, ObjectsSettings>(
      {.name = ObjectsSettings::module,
       .summary = "Writes the tracks of moving objects (filter motion_objects) to objects.csv."});
}

}  // namespace holdfast
