// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "depth_clusters.hpp"
#include "holdfast/core/coarse_view.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"
#include "motion_objects.hpp"

namespace holdfast::motion_objects_plugin {
namespace {

using Eigen::Vector3d;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// What was tracked of one thing under one id, beside the truth.
struct Followed {
  std::vector<Vector3d> offsets;  // of the track from the truth
  std::vector<double> velocity_errors;

  /// Median distance from the mean offset: the visible surface is not the middle of the thing.
  double position_error() const {
    Vector3d mean = Vector3d::Zero();
    for (const Vector3d& offset : offsets) mean += offset / static_cast<double>(offsets.size());
    std::vector<double> distances;
    for (const Vector3d& offset : offsets) distances.push_back((offset - mean).norm());
    return median(distances);
  }
};

TEST(MotionObjectsAccuracy, APushedChairIsFollowedWithoutMasks) {
  // Depth clusters and true poses alone: no map, no network.
  const Camera camera = *find_camera("tum_fr3");
  simulation::Simulator simulator(
      simulation::read_scene(std::string(HOLDFAST_SOURCE_DIR) + "/examples/scenes/box_and_chair.yaml", {}), camera);
  const auto& numbered = simulator.numbered_objects();
  const auto chair = std::find_if(numbered.begin(), numbered.end(), [&](const simulation::NumberedObject& each) {
    return simulator.object(each).name == "chair 1";
  });
  ASSERT_NE(chair, numbered.end());
  const auto truth_at = [&](double time) -> Vector3d { return simulator.object(*chair).pose(time).translation(); };

  CreationContext context;
  context.camera = camera;
  depth_clusters_plugin::DepthClusters clusters({}, context);
  MotionObjects objects({}, context);
  const CoarseSampler sampler(camera);
  const Map map;
  Frame frame, previous;
  std::map<std::uint32_t, Followed> on_chair;
  constexpr std::uint64_t first = 75, last = 165;  // the chair comes towards the camera
  for (std::uint64_t index = first; index < last; ++index) {
    const SensorFrame image = simulator.frame(index);
    frame = Frame();
    frame.index = index;
    frame.timestamp = image.timestamp;
    frame.camera = std::make_shared<Camera>(camera);
    frame.coarse.grid = sampler.grid();
    sampler.sample_depth(image.depth, frame.coarse);
    frame.T_camera_world = image.truth->T_world_camera->inverse();
    StaticEvidence evidence(0, frame.coarse.depth.size());
    const FilterContext seen{.sensor_frame = image,
                             .frame = frame,
                             .previous = index > first ? &previous : nullptr,
                             .map = map,
                             .T_camera_world = &frame.T_camera_world};
    evidence.begin_stage("depth_clusters");
    clusters.apply(seen, evidence);
    evidence.begin_stage("motion_objects");
    objects.apply(seen, evidence);
    constexpr double step = 0.1;
    const Vector3d velocity = (truth_at(image.timestamp + step) - truth_at(image.timestamp - step)) / (2 * step);
    for (const MovingObject& object : evidence.objects()) {
      if (object.last_seen < image.timestamp || index < first + 30) continue;
      const Vector3d in_camera = frame.T_camera_world * object.T_world_object.translation();
      const Eigen::Vector2d pixel = camera.distort(camera.project(in_camera));
      const int x = std::clamp(static_cast<int>(pixel.x()), 0, camera.width - 1);
      const int y = std::clamp(static_cast<int>(pixel.y()), 0, camera.height - 1);
      if (image.truth->object_mask.at<std::uint8_t>(y, x) != chair->number) continue;
      Followed& followed = on_chair[object.id];
      followed.offsets.push_back(object.T_world_object.translation() - truth_at(image.timestamp));
      followed.velocity_errors.push_back((object.velocity - velocity).norm());
    }
    previous = frame;
  }
  ASSERT_FALSE(on_chair.empty());
  const auto& [id, most] = *std::max_element(on_chair.begin(), on_chair.end(), [](const auto& a, const auto& b) {
    return a.second.offsets.size() < b.second.offsets.size();
  });
  RecordProperty("frames", static_cast<int>(most.offsets.size()));
  RecordProperty("position_error_mm", static_cast<int>(1000 * most.position_error()));
  RecordProperty("velocity_error_mm_s", static_cast<int>(1000 * median(most.velocity_errors)));
  EXPECT_GE(most.offsets.size(), 30U) << "id " << id;
  EXPECT_LT(most.position_error(), 0.06);
  EXPECT_LT(median(most.velocity_errors), 0.08);
}

}  // namespace
}  // namespace holdfast::motion_objects_plugin
