// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "holdfast/plugin/registry.hpp"
#include "holdfast/tracking/frame_builder.hpp"
#include "holdfast/tracking/image_depth.hpp"

namespace holdfast::test {

/// The frames of a source with the features of `orb`, for a filter alone: no tracking, an empty map.
class JudgedFrames {
 public:
  JudgedFrames(const std::string& source, const ParameterValues& values, const std::string& camera = "tum_fr1") {
    register_builtin_plugins(registry_);
    context_.camera = *find_camera(camera);
    source_ = registry_.create<FrameSource>(source, values, context_);
    extractor_ = registry_.create<FeatureExtractor>("orb", {}, context_);
    depth_ = std::make_unique<ImageDepth>(context_.camera, 0.0);
    builder_ = std::make_unique<FrameBuilder>(context_.camera, *extractor_, *depth_);
  }

  const CreationContext& context() const { return context_; }

  /// Applies the filter to every frame that is left and hands what it said to `judged`.
  using Judged = std::function<void(const SensorFrame&, const Frame&, const StaticEvidence&)>;
  void run(DynamicFilter& filter, const Judged& judged) { run(filter, nullptr, judged); }

  /// The same with the frame before, and with the true pose after an error that may depend on the frame.
  using PoseError = std::function<Eigen::Isometry3d(std::uint64_t index)>;
  void run_with_poses(DynamicFilter& filter, const PoseError& error, const Judged& judged) {
    run(filter, &error, judged);
  }

 private:
  void run(DynamicFilter& filter, const PoseError* error, const Judged& judged) {
    const Map map;
    Frame frame, previous;
    bool has_previous = false;
    while (const std::optional<SensorFrame> image = source_->next()) {
      StageTimes times;
      builder_->build(*image, frame, times);
      StaticEvidence evidence(frame.size(), frame.coarse.depth.size());
      evidence.begin_stage("filter");
      if (error == nullptr) {
        filter.apply({.sensor_frame = *image, .frame = frame, .map = map}, evidence);
      } else {
        frame.T_camera_world = image->truth->T_world_camera->inverse();
        const Eigen::Isometry3d T_camera_world = (*error)(image->index) * frame.T_camera_world;
        filter.apply({.sensor_frame = *image,
                      .frame = frame,
                      .previous = has_previous ? &previous : nullptr,
                      .map = map,
                      .T_camera_world = &T_camera_world},
                     evidence);
      }
      judged(*image, frame, evidence);
      std::swap(frame, previous);
      has_previous = true;
    }
  }

  Registry registry_;
  CreationContext context_;
  std::unique_ptr<FrameSource> source_;
  std::unique_ptr<FeatureExtractor> extractor_;
  std::unique_ptr<ImageDepth> depth_;
  std::unique_ptr<FrameBuilder> builder_;
};

/// Where a feature lies by truth: on what stands still, on what moves, or so near the border between them that its
/// patch shows both.
enum class Surface { still, moving, border };
inline Surface surface_of(const SensorFrame& image, const Frame& frame, std::size_t feature) {
  constexpr int margin = 6;  // px
  if (!image.truth || image.truth->object_mask.empty()) return Surface::still;
  const cv::Mat& mask = image.truth->object_mask;
  const auto moves = [&](int column, int row) {
    const auto number = mask.at<std::uint8_t>(std::clamp(row, 0, mask.rows - 1), std::clamp(column, 0, mask.cols - 1));
    return std::binary_search(image.truth->moving_objects.begin(), image.truth->moving_objects.end(), number);
  };
  const int x = static_cast<int>(std::lround(frame.features.x[feature])),
            y = static_cast<int>(std::lround(frame.features.y[feature]));
  const bool here = moves(x, y);
  for (const int dy : {-margin, 0, margin})
    for (const int dx : {-margin, 0, margin})
      if (moves(x + dx, y + dy) != here) return Surface::border;
  return here ? Surface::moving : Surface::still;
}

}  // namespace holdfast::test
