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

/// Number of cells of a grid over the image with a position of a problem or frame that `one` explains and `other` not.
template <class Positions>
int cells_of_one_alone(const Positions& at, const std::vector<bool>& one, const std::vector<bool>& other) {
  constexpr int cells_across = 10;  // a vehicle is in few of them, however many features it has
  const double side = static_cast<double>(at.camera->width) / cells_across;
  std::vector<int> cells;
  for (std::size_t i = 0; i < at.size(); ++i)
    if (one[i] && !other[i])
      cells.push_back(static_cast<int>(at.x[i] / side) + cells_across * static_cast<int>(at.y[i] / side));
  std::sort(cells.begin(), cells.end());
  return static_cast<int>(std::unique(cells.begin(), cells.end()) - cells.begin());
}

template <class Positions>
bool is_wider(const Positions& at, const std::vector<bool>& one, const std::vector<bool>& other) {
  constexpr double lead = 1.5;
  return cells_of_one_alone(at, one, other) > lead * cells_of_one_alone(at, other, one);
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
    if (is_wider(all, found.explains, best.explains)) best = found, has_won = true;
  }
  if (!has_won) return false;
  std::size_t observation = 0;
  for (std::size_t i = 0; i < frame.size(); ++i)
    if (frame.map_points[i].valid() && !best.explains[observation++]) frame.map_points[i] = MapPointId();
  frame.T_camera_world = best.T_camera_world;
  return true;
}

/// The widest motion of descriptor matches with the reference keyframe; if it is the frame's own one, the frame stays.
void test_descriptor_matches(TrackingContext& context) {
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

/// Which features have a match.
std::vector<bool> matched(const Frame& frame) {
  std::vector<bool> result(frame.size());
  for (std::size_t i = 0; i < frame.size(); ++i) result[i] = frame.map_points[i].valid();
  return result;
}

/// Searches the points of the previous frame as a camera sees them that drives forward at several speeds. Few points of
/// a road have like descriptors after some metres.
void test_speeds(TrackingContext& context) {
  constexpr double step = 0.5;  // m
  constexpr int steps = 8;
  if (!context.history.has_previous()) return;
  Frame& frame = context.current;
  const Eigen::Isometry3d standing = context.previous.T_camera_world;
  std::vector<MapPointId> best_matches = frame.map_points;
  Eigen::Isometry3d best_pose = frame.T_camera_world;
  std::vector<bool> best = matched(frame);
  bool has_won = false;
  for (int k = 1; k <= steps; ++k) {
    frame.T_camera_world = Eigen::Translation3d(0.0, 0.0, -step * k) * standing;
    const int matches =
        context.matcher.match_previous(context.previous, static_cast<float>(context.settings.motion_window), frame);
    if (matches < context.settings.minimum_matches) continue;
    if (context.estimator.adjust(frame) < context.settings.minimum_matches / 2) continue;
    const double apart = (frame.T_camera_world * best_pose.inverse()).translation().norm();
    if (apart < step / 2.0) continue;  // the same motion
    context.estimator.drop_outliers(frame);
    std::vector<bool> found = matched(frame);
    if (!is_wider(frame, found, best)) continue;
    best = std::move(found), best_matches = frame.map_points, best_pose = frame.T_camera_world;
    has_won = true;
  }
  frame.map_points = best_matches;
  frame.T_camera_world = best_pose;
  if (!has_won) return;
  context.estimator.adjust(frame);
  context.estimator.drop_outliers(frame);
}

}  // namespace

void test_start_motion(TrackingContext& context) {
  test_descriptor_matches(context);
  test_speeds(context);
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
