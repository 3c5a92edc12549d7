// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "holdfast/core/health_reason_names.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/interfaces/observer.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/health.hpp"

namespace holdfast {

void HealthSettings::describe(ParameterTable<HealthSettings>& table) {
  table.add("truth", &HealthSettings::truth, "also write true poses, where the source has them");
}

namespace {

/// Writes the health of frames to health.csv at the end of a run. Needs an output folder, and does nothing without one.
class Health final : public Observer {
 public:
  Health(const HealthSettings& settings, const CreationContext& context)
      : settings_(settings), folder_(context.output_directory), text_(header()) {}

  void on_frame(const SensorFrame& frame, const Frame&, const FrameResult& result) override {
    if (folder_.empty()) return;
    if (!result.is_keyframe && result.keyframe.valid()) reference_ = result.keyframe;
    add("%.6f", result.timestamp);
    text_ += std::string(",") + to_string(result.health.state) + "," + reason_text(result.health.reasons) + ",";
    add("%.4f,", result.health.jump);
    const auto reference = stamps_.find(reference_);
    if (reference != stamps_.end()) add("%.6f", reference->second);
    add_pose(result.T_world_camera);
    for (int row = 0; row < 6; ++row)
      for (int column = row; column < 6; ++column) {
        text_ += ",";
        if (result.covariance) add("%.6g", (*result.covariance)(row, column));
      }
    add_pose(settings_.truth && frame.truth ? frame.truth->T_world_camera : std::nullopt);
    text_ += "\n";
    if (!result.is_keyframe) return;
    reference_ = result.keyframe;
    stamps_[reference_] = result.timestamp;
  }
  void on_finish(const Map&) override {
    if (!folder_.empty()) write_file_atomically(folder_ / "health.csv", text_);
  }

 private:
  static std::string header() {
    std::string text = "timestamp,state,reasons,jump,reference,x,y,z,qx,qy,qz,qw";
    for (int row = 0; row < 6; ++row)
      for (int column = row; column < 6; ++column) text += ",c" + std::to_string(row) + std::to_string(column);
    return text + ",true_x,true_y,true_z,true_qx,true_qy,true_qz,true_qw\n";
  }
  static std::string reason_text(const HealthReasons& reasons) {
    std::string text;
    for (const std::string& name : names_of(reasons)) text += (text.empty() ? "" : ";") + name;
    return text;
  }
  void add(const char* format, double value) {
    char text[48];
    std::snprintf(text, sizeof(text), format, value);
    text_ += text;
  }
  void add_pose(const std::optional<Eigen::Isometry3d>& pose) {
    if (!pose) {
      text_ += ",,,,,,,";
      return;
    }
    const Eigen::Quaterniond turn(pose->linear());
    for (const double value : {pose->translation().x(), pose->translation().y(), pose->translation().z(), turn.x(),
                               turn.y(), turn.z(), turn.w()})
      add(",%.9f", value);
  }

  HealthSettings settings_;
  std::filesystem::path folder_;
  std::string text_;
  std::map<KeyFrameId, double> stamps_;  // of keyframes
  KeyFrameId reference_;                 // by which this frame was tracked
};

}  // namespace

HOLDFAST_PLUGIN(health, registry) {
  registry.add<Observer, Health, HealthSettings>(
      {.name = HealthSettings::module,
       .summary = "Writes the health of every frame, with pose and covariance, to health.csv."});
}

}  // namespace holdfast
