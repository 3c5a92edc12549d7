// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <optional>

#include "holdfast/interfaces/observer.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/mcap.hpp"
#include "mcap_writer.hpp"
#include "messages.hpp"

namespace holdfast {

void McapSettings::describe(ParameterTable<McapSettings>& table) {
  using S = McapSettings;
  table
      .add("image_every", &S::image_every,
           "an image and its moving cells are written for every frame whose index is a multiple of this number; 0 = "
           "no images")
      .range(0, 100000);
  table.add("quality", &S::quality, "JPEG quality of the images").range(1, 100);
  table
      .add("map_interval", &S::map_interval,
           "minimum time between two states of the map (keyframes and points); the last one is always written")
      .range(0, 1e6)
      .unit("s");
}

namespace {

using namespace mcap_plugin;

/// The axes of `map` in terms of those of `world`: x forwards, y left, z up.
Eigen::Isometry3d T_map_world() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return T;
}

/// Writes what a run finds to run.mcap. Needs an output folder, and does nothing without one. The tracking and the
/// mapping thread share the file.
class Mcap final : public Observer {
 public:
  Mcap(const McapSettings& settings, const CreationContext& context)
      : settings_(settings), folder_(context.output_directory) {}

  void on_frame(const SensorFrame& sensor_frame, const Frame& frame, const FrameResult& result) override {
    if (folder_.empty()) return;
    const std::lock_guard lock(mutex_);
    if (!writer_) open();
    const double time = time_ = result.timestamp;
    write(status_, status_message(result));
    write(transforms_, transform_message(time, map_frame, world_frame, T_map_world()));
    if (result.T_world_camera) {
      write(pose_, pose_message(time, *result.T_world_camera));
      write(transforms_, transform_message(time, world_frame, camera_frame, *result.T_world_camera));
    }
    if (!result.objects.empty()) write(objects_, objects_message(time, result.objects));
    if (settings_.image_every == 0 || sensor_frame.index % static_cast<std::uint64_t>(settings_.image_every) != 0)
      return;
    if (!sensor_frame.colour.empty()) write(image_, image_message(time, sensor_frame.colour, settings_.quality));
    if (frame.coarse.grid.size() > 0) write(moving_, moving_message(time, frame.coarse));
  }

  void on_keyframe(KeyFrameId, const ObservedMap& map) override {
    {
      const std::lock_guard lock(mutex_);
      if (!writer_ || time_ < map_time_ + settings_.map_interval) return;
      map_time_ = time_;
    }
    const MapSnapshot& snapshot = map.snapshot();
    const std::lock_guard lock(mutex_);
    write_map(snapshot);
  }

  void on_finish(const Map& map) override {
    if (!writer_) return;
    write_map(make_snapshot(map));
    writer_->close();
    writer_.reset();
  }

 private:
  /// With the first frame: until then the folder may be cleared of earlier results.
  void open() {
    writer_.emplace(folder_ / "run.mcap");
    status_ = add("/status", "holdfast.FrameStatus");
    pose_ = add("/camera/pose", "foxglove.PoseInFrame");
    transforms_ = add("/tf", "foxglove.FrameTransform");
    objects_ = add("/objects", "foxglove.SceneUpdate");
    image_ = add("/camera/image", "foxglove.CompressedImage");
    moving_ = add("/camera/moving", "foxglove.CompressedImage");
    path_ = add("/map/keyframes", "foxglove.PosesInFrame");
    points_ = add("/map/points", "foxglove.PointCloud");
  }
  std::uint16_t add(const char* topic, const char* schema) {
    return writer_->add_channel(topic, schema, schema_document(schema));
  }
  void write(std::uint16_t channel, const Json& message) {
    writer_->write(channel, static_cast<std::uint64_t>(std::llround(std::max(time_, 0.0) * 1e9)), message.dump());
  }
  void write_map(const MapSnapshot& snapshot) {
    write(path_, path_message(time_, snapshot.keyframes));
    write(points_, cloud_message(time_, snapshot.points));
  }

  McapSettings settings_;
  std::filesystem::path folder_;
  std::mutex mutex_;
  std::optional<McapWriter> writer_;
  double time_ = 0.0;  // of the last frame [s]
  double map_time_ = -1e300;
  std::uint16_t status_ = 0, pose_ = 0, transforms_ = 0, objects_ = 0, image_ = 0, moving_ = 0, path_ = 0, points_ = 0;
};

}  // namespace

HOLDFAST_PLUGIN(mcap, registry) {
  registry.add<Observer, Mcap, McapSettings>(
      {.name = McapSettings::module,
       .summary = "Writes poses, map, moving objects, images and the state of every frame to run.mcap, for Foxglove."});
}

}  // namespace holdfast
