// SPDX-License-Identifier: BSD-3-Clause
#include "plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <tuple>

#include "holdfast/geometry/so3.hpp"
#include "holdfast/interfaces/frame_observations.hpp"
#include "holdfast/matching/frame_features.hpp"

namespace holdfast {
namespace {
constexpr double degrees_per_radian = 180.0 / std::numbers::pi;
constexpr double longest_gap = 5.0;  // [s]
constexpr int held_weight = 2 * minimum_shared_points;

double turn_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return geometry::log_so3(Eigen::Matrix3d(a.linear() * b.linear().transpose())).norm();
}
Eigen::Vector3d centre_of(const Eigen::Isometry3d& T_camera_world) {
  return -(T_camera_world.linear().transpose() * T_camera_world.translation());
}
}  // namespace

double path_length(const Map& map, KeyFrameId from, KeyFrameId to, double metres_per_second) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  std::vector<double> lengths(map.keyframes().slot_count(), infinite);
  using Entry = std::pair<double, KeyFrameId>;  // ids break ties, so that the order is the same in every run
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  lengths[from.slot] = 0.0;
  queue.emplace(0.0, from);
  while (!queue.empty()) {
    const double length = queue.top().first;
    const KeyFrameId id = queue.top().second;
    queue.pop();
    if (id == to) return length;
    if (length > lengths[id.slot]) continue;
    const KeyFrame& keyframe = map.keyframe(id);
    const Eigen::Isometry3d& pose = keyframe.frame.T_camera_world;
    const auto visit = [&](KeyFrameId next, bool is_held) {
      const Frame& other = map.keyframe(next).frame;
      const double metres = (centre_of(pose) - centre_of(other.T_camera_world)).norm();
      double next_length = length + metres + turn_between(pose, other.T_camera_world);
      if (!is_held)
        next_length += metres_per_second * std::min(longest_gap, std::abs(other.timestamp - keyframe.frame.timestamp));
      if (next_length >= lengths[next.slot]) return;
      lengths[next.slot] = next_length;
      queue.emplace(next_length, next);
    };
    // An edge of the spanning tree that is held is one of covisibility as well, unless these need more shared points.
    for (const CovisibilityEdge& edge : keyframe.covisible) visit(edge.keyframe, edge.weight >= held_weight);
    for (const KeyFrameId child : keyframe.children) visit(child, false);
    for (const KeyFrameId other : keyframe.loop_edges) visit(other, true);
    if (keyframe.parent.valid()) visit(keyframe.parent, false);
  }
  return infinite;
}

PoseChange pose_change(const Eigen::Isometry3d& before, const Eigen::Isometry3d& after) {
  return {(centre_of(before) - centre_of(after)).norm(), turn_between(before, after) * degrees_per_radian};
}

PoseChange drift_bound(const LoopClosingSettings& settings, double path_length, bool scale_is_free) {
  // The scale of one camera drifts, and with it the length of the path.
  const double per_metre = scale_is_free ? settings.drift_per_metre_mono : settings.drift_per_metre;
  return {settings.drift_constant + per_metre * path_length,
          settings.turn_constant + settings.turn_per_metre * path_length};
}

PlacePoints old_points_in_view(const LoopClosingSettings& settings, const Map& map, KeyFrameId id) {
  const KeyFrame& keyframe = map.keyframe(id);
  const std::vector<std::uint8_t> near = [&] {
    std::vector<std::uint8_t> marks(map.keyframes().slot_count(), 0);
    marks[id.slot] = 1;
    for (const CovisibilityEdge& edge : keyframe.covisible) marks[edge.keyframe.slot] = 1;
    map.keyframes().for_each([&](KeyFrameId other, const KeyFrame& value) {
      if (value.sequence + static_cast<std::uint64_t>(settings.minimum_gap) > keyframe.sequence) marks[other.slot] = 1;
    });
    return marks;
  }();
  const FrameProjection projection = projection_into(keyframe.frame, keyframe.frame.T_camera_world);
  PlacePoints points;
  map.points().for_each([&](MapPointId point_id, const MapPoint& point) {
    if (!projection.expect(point.position.cast<float>(), point.viewing_direction.cast<float>(), point.minimum_distance,
                           point.maximum_distance))
      return;
    for (const Observation& observation : point.observations)
      if (near[observation.keyframe.slot] != 0) return;
    points.add(point_id, point);
  });
  return points;
}

bool present_pose_is_confirmed(const LoopClosingSettings& settings, const FeatureMatcher& matcher, Optimizer& optimizer,
                               const Frame& frame, const PlacePoints& old_points,
                               const Eigen::Isometry3d& T_camera_world_loop) {
  // If the loop moves the keyframe by little, its points and the old points in view are the same.
  constexpr double agreeing_metres = 0.05, agreeing_degrees = 2.0;
  Eigen::Isometry3d T_camera_world = frame.T_camera_world;
  int inliers = 0;
  for (const double radius : {3.0 * settings.search_radius, settings.search_radius}) {
    const PointSearch search =
        find_points(matcher, old_points.block, frame, T_camera_world, radius, settings.match_distance);
    PoseProblem problem = pose_problem_of(old_points, frame, search.matches, T_camera_world);
    const PoseSummary summary = optimizer.optimize_pose(problem);
    if (!summary.usable) return false;
    T_camera_world = problem.T_camera_world;
    inliers = summary.inliers;
  }
  // No minimum share is required: most distant points in view may be occluded.
  if (inliers < settings.minimum_inliers) return false;
  const PoseChange difference = pose_change(T_camera_world, T_camera_world_loop);
  return difference.metres > agreeing_metres || difference.degrees > agreeing_degrees;
}

}  // namespace holdfast
