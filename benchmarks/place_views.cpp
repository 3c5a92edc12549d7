// SPDX-License-Identifier: BSD-3-Clause
#include "place_views.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "holdfast/config/configuration.hpp"
#include "holdfast/core/association.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "holdfast/run/configured_pipeline.hpp"

namespace holdfast {

namespace {

constexpr int columns = 32;
constexpr int rows = 24;

double column_position(const Camera& camera, int column) { return (column + 0.5) * camera.width / columns - 0.5; }
double row_position(const Camera& camera, int row) { return (row + 0.5) * camera.height / rows - 0.5; }

}  // namespace

PlaceView view_of(const Camera& camera, const SensorFrame& frame, const Eigen::Isometry3d& T_world_camera) {
  PlaceView view;
  view.timestamp = frame.timestamp;
  view.T_world_camera = T_world_camera;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      view.depth.push_back(frame.depth.at<float>(static_cast<int>(std::lround(row_position(camera, row))),
                                                 static_cast<int>(std::lround(column_position(camera, column)))));
  return view;
}

PlaceRecording read_recording(const std::string& source, int step) {
  Registry registry;
  register_builtin_plugins(registry);
  const std::string text = "source: " + source + "\ncamera: tum_fr1\nfeatures: orb\noptimizer: ceres\n";
  BuiltPipeline built = build_pipeline(
      resolve_configuration(parse_yaml(text, "source", "."), "source", registry, pipeline_sections()), registry);
  const auto extractor = registry.create<FeatureExtractor>("orb", {}, {});

  PlaceRecording recording;
  const SourceDescription description = built.source->describe();
  recording.name = description.name;
  recording.camera = description.camera.value_or(built.pipeline.camera());
  const Trajectory truth = built.source->truth();
  std::vector<double> truth_stamps;
  for (const TimedPose& pose : truth) truth_stamps.push_back(pose.timestamp);

  while (const auto frame = built.source->next()) {
    if (frame->index % static_cast<std::uint64_t>(step) != 0) continue;
    const double stamp[] = {frame->timestamp};
    const auto pairs = associate_stamps(stamp, truth_stamps, 0.02);
    if (pairs.empty()) continue;
    PlaceView& view =
        recording.views.emplace_back(view_of(recording.camera, *frame, truth[pairs[0].second].T_world_camera));
    cv::Mat grey;
    cv::cvtColor(frame->colour, grey, cv::COLOR_BGR2GRAY);
    Features features;
    extractor->extract(grey, {}, features);
    view.descriptors = std::move(features.descriptors);
  }
  return recording;
}

double shared_view(const Camera& camera, const PlaceView& a, const PlaceView& b) {
  const Eigen::Isometry3d T_b_a = b.T_world_camera.inverse() * a.T_world_camera;
  if (T_b_a.linear()(2, 2) < std::cos(std::numbers::pi / 3.0)) return 0.0;
  int measured = 0;
  int shared = 0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double depth = a.depth[static_cast<std::size_t>(row * columns + column)];
      if (depth <= 0.0) continue;
      ++measured;
      const Eigen::Vector3d point =
          T_b_a * camera.back_project(column_position(camera, column), row_position(camera, row), depth);
      if (point.z() <= 0.1) continue;
      const Eigen::Vector2d pixel = camera.project(point);
      const int column_b = static_cast<int>(std::floor((pixel.x() + 0.5) * columns / camera.width));
      const int row_b = static_cast<int>(std::floor((pixel.y() + 0.5) * rows / camera.height));
      if (column_b < 0 || column_b >= columns || row_b < 0 || row_b >= rows) continue;
      const double depth_b = b.depth[static_cast<std::size_t>(row_b * columns + column_b)];
      if (depth_b > 0.0 && std::abs(depth_b - point.z()) < std::max(0.05, 0.05 * point.z())) ++shared;
    }
  }
  return measured > 0 ? static_cast<double>(shared) / measured : 0.0;
}

}  // namespace holdfast
