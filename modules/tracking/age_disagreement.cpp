// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/age_disagreement.hpp"

#include <optional>

#include "holdfast/geometry/pose_problem.hpp"
#include "holdfast/interfaces/frame_observations.hpp"
#include "holdfast/matching/frame_features.hpp"
#include "holdfast/tracking/pose_covariance.hpp"

namespace holdfast {

namespace {

using geometry::Matrix6d;

constexpr double newest_age = 0.5;          // [s]
constexpr std::size_t smallest_group = 15;  // points
constexpr double chi_square_six = 12.592;

/// Points of one age, and the pose that they say.
struct Group {
  PoseProblem problem;
  PoseCovariance calibration;
  Matrix6d covariance;

  void begin(const Frame& frame) {
    problem.clear();
    problem.camera = frame.camera.get();
    problem.T_camera_world = frame.T_camera_world;
  }
  bool solve() {
    // Begins at the pose of both groups, so that few steps are enough.
    constexpr geometry::PoseAdjustmentOptions brief{.robust_rounds = 1, .final_rounds = 1, .iterations = 3};
    const PoseSummary summary = geometry::adjust_pose(problem, brief);
    if (!summary.usable || summary.inliers < static_cast<int>(smallest_group)) return false;
    covariance =
        calibration.calibrated_covariance(problem, summary.covariance, KeyFrameId(), Eigen::Isometry3d::Identity());
    return true;
  }
};

/// Whether the point was first seen less than `newest_age` ago; empty without a keyframe that saw it. A loaded map may
/// be of a later recording.
std::optional<bool> is_new(const MapPoint& point, const Map& map, double now) {
  const KeyFrame* first = map.find_keyframe(point.reference_keyframe);
  if (first == nullptr) return std::nullopt;
  const double age = now - first->frame.timestamp;
  return age >= 0.0 && age < newest_age;
}

void sort_by_age(const Frame& frame, const Map& map, Group& older, Group& newer) {
  older.begin(frame), newer.begin(frame);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const bool counts = frame.map_points[i].valid() && is_static(frame, i);
    const MapPoint* point = counts ? map.find_point(frame.map_points[i]) : nullptr;
    if (point == nullptr) continue;
    if (const std::optional<bool> found = is_new(*point, map, frame.timestamp))
      add_observation(*found ? newer.problem : older.problem, frame, i, point->position);
  }
  older.problem.inlier.assign(older.problem.size(), 0);
  newer.problem.inlier.assign(newer.problem.size(), 0);
}

}  // namespace

Matrix6d age_disagreement(const Frame& frame, const Map& map) {
  thread_local Group older, newer;
  sort_by_age(frame, map, older, newer);
  const std::size_t all = older.problem.size() + newer.problem.size();
  const bool is_even = older.problem.size() >= smallest_group && newer.problem.size() >= smallest_group &&
                       4 * newer.problem.size() >= all;
  if (!is_even || !older.solve() || !newer.solve()) return Matrix6d::Zero();
  const geometry::Vector6d between =
      geometry::log_se3(older.problem.T_camera_world * newer.problem.T_camera_world.inverse());
  const Matrix6d covariance = older.covariance + newer.covariance;
  if (between.dot(covariance.ldlt().solve(between)) < chi_square_six) return Matrix6d::Zero();
  return 0.25 * between * between.transpose();
}

}  // namespace holdfast
