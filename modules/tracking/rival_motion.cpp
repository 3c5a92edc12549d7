// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/rival_motion.hpp"

#include <algorithm>
#include <vector>

#include "holdfast/geometry/pose_problem.hpp"

namespace holdfast {

namespace {

/// A pose and which observations of a problem it explains.
struct Motion {
  Eigen::Isometry3d T_camera_world;
  std::vector<bool> explains;
};

Motion motion_of(const PoseProblem& problem, const Eigen::Isometry3d& T_camera_world) {
  Motion motion{T_camera_world, std::vector<bool>(problem.size(), false)};
  for (std::size_t i = 0; i < problem.size(); ++i) {
    const Eigen::Vector3d point = T_camera_world * problem.points[i];
    if (!(point.z() > 0.0)) continue;
    const Eigen::Vector2d error = problem.camera->project(point) - Eigen::Vector2d(problem.x[i], problem.y[i]);
    motion.explains[i] = error.squaredNorm() * problem.inverse_sigma2[i] < geometry::chi_square_two;
  }
  return motion;
}

/// Number of cells of a grid over the image with an observation that `one` explains and `other` does not.
int cells_of_one_alone(const PoseProblem& problem, const Motion& one, const Motion& other) {
  constexpr int cells_across = 10;  // a vehicle is in few of them, however many features it has
  const double side = static_cast<double>(problem.camera->width) / cells_across;
  std::vector<int> cells;
  for (std::size_t i = 0; i < problem.size(); ++i)
    if (one.explains[i] && !other.explains[i])
      cells.push_back(static_cast<int>(problem.x[i] / side) + cells_across * static_cast<int>(problem.y[i] / side));
  std::sort(cells.begin(), cells.end());
  return static_cast<int>(std::unique(cells.begin(), cells.end()) - cells.begin());
}

bool is_wider(const PoseProblem& problem, const Motion& one, const Motion& other) {
  constexpr double lead = 1.5;
  return cells_of_one_alone(problem, one, other) > lead * cells_of_one_alone(problem, other, one);
}

/// Gives the current frame the pose of the widest motion of its matches, of which the estimator's problem consists, and
/// the matches that it explains; false, and frame and problem as they were, if that is its own pose.
bool choose_motion(TrackingContext& context) {
  Frame& frame = context.current;
  const PoseProblem& all = context.estimator.problem();
  PoseProblem problem = all;
  const geometry::PnpOptions options{.minimum_inliers = context.settings.minimum_inliers};
  Motion best = motion_of(all, frame.T_camera_world), found = best;
  // A pose between two motions explains neither: the second rival is found among what the first leaves.
  constexpr int rivals = 2;
  bool has_won = false;
  for (int k = 0; k < rivals; ++k) {
    for (std::size_t i = 0; i < problem.size(); ++i)
      if (found.explains[i]) problem.weight[i] = 0.0F;
    if (!geometry::find_pose(problem, options).usable) break;
    found = motion_of(all, problem.T_camera_world);
    if (is_wider(all, found, best)) best = found, has_won = true;
  }
  if (!has_won) return false;
  std::size_t observation = 0;
  for (std::size_t i = 0; i < frame.size(); ++i)
    if (frame.map_points[i].valid() && !best.explains[observation++]) frame.map_points[i] = MapPointId();
  frame.T_camera_world = best.T_camera_world;
  return true;
}

}  // namespace

void test_start_motion(TrackingContext& context) {
  const KeyFrame* keyframe = context.map.find_keyframe(context.reference_keyframe);
  if (keyframe == nullptr) return;
  Frame& frame = context.current;
  const std::vector<MapPointId> own_matches = frame.map_points;
  const Eigen::Isometry3d own_pose = frame.T_camera_world;
  if (context.matcher.match_keyframe(keyframe->frame, frame) >= context.settings.minimum_matches) {
    context.estimator.build_problem(frame);
    if (choose_motion(context)) {
      context.estimator.adjust(frame);
      context.estimator.drop_outliers(frame);
      return;
    }
  }
  frame.map_points = own_matches;
  frame.T_camera_world = own_pose;
}

bool test_local_motion(TrackingContext& context) {
  constexpr double many = 0.3;  // of the matches
  const PoseProblem& problem = context.estimator.problem();
  const auto outliers = std::count(problem.inlier.begin(), problem.inlier.end(), std::uint8_t{0});
  if (outliers < 2 * context.settings.minimum_inliers ||
      static_cast<double>(outliers) < many * context.estimator.matches())
    return false;
  return choose_motion(context);
}

}  // namespace holdfast
