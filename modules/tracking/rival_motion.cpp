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

constexpr double usual_lead = 1.5;                    // of a motion in cells over the one so far
constexpr double step_of_speeds = 0.5;                // m
constexpr double same_motion = step_of_speeds / 2.0;  // m; poses nearer to each other are those of one motion

template <class Positions>
bool is_wider(const Positions& at, const std::vector<bool>& one, const std::vector<bool>& other,
              double lead = usual_lead) {
  return cells_of_one_alone(at, one, other) > lead * cells_of_one_alone(at, other, one);
}

double distance(const Eigen::Isometry3d& one, const Eigen::Isometry3d& other) {
  return (one * other.inverse()).translation().norm();
}

/// The lead that a rival needs. A vehicle does not change its speed by metres from one frame to the next, but another
/// one may come to have more matches than the road: of two motions, the one that was predicted wins unless the other
/// has the usual lead over it. Without a velocity, a camera that stands is not more likely than one that drives.
double needed_lead(const TrackingContext& context, const Eigen::Isometry3d& own, const Eigen::Isometry3d& rival) {
  if (!context.history.has_velocity()) return distance(own, rival) < same_motion ? usual_lead : 1.0;
  const Eigen::Isometry3d predicted = context.predicted_pose();
  const bool is_predicted = distance(rival, predicted) < same_motion;
  return is_predicted && distance(own, predicted) > same_motion ? 1.0 / usual_lead : usual_lead;
}

/// Takes the weight from features whose matches support another motion than that of the frame alone: they move, and
/// would make points of the map that draw later frames along.
void mark_moving(const Motion& motion, const Motion& other, Frame& frame) {
  std::size_t observation = 0;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (!frame.map_points[i].valid()) continue;
    if (!motion.explains[observation] && other.explains[observation]) frame.static_probability[i] = 0.0F;
    ++observation;
  }
}

/// Gives a frame a motion, and the matches that it explains.
void keep_motion(const Motion& motion, Frame& frame) {
  std::size_t observation = 0;
  for (std::size_t i = 0; i < frame.size(); ++i)
    if (frame.map_points[i].valid() && !motion.explains[observation++]) frame.map_points[i] = MapPointId();
  frame.T_camera_world = motion.T_camera_world;
}

/// Gives the current frame the pose of the widest motion of its matches, of which the estimator's problem consists, and
/// the matches that it explains; false, and frame and problem as they were but for marks of what moves, if that is its
/// own pose.
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
    if (is_wider(all, found.explains, best.explains, needed_lead(context, best.T_camera_world, found.T_camera_world))) {
      mark_moving(found, best, frame);
      best = found, has_won = true;
    } else if (is_wider(all, best.explains, found.explains)) {
      mark_moving(best, found, frame);
    }
  }
  if (has_won) keep_motion(best, frame);
  return has_won;
}

/// Gives the frame the motion with which its adjustment began, and the matches that it explains, if the adjustment has
/// left it for one that is not wider. Returns whether it has.
bool return_to_motion(TrackingContext& context, const Eigen::Isometry3d& began) {
  Frame& frame = context.current;
  if (distance(frame.T_camera_world, began) < same_motion) return false;
  const PoseProblem& all = context.estimator.problem();
  const Motion first = motion_of(all, began), own = motion_of(all, frame.T_camera_world);
  if (!is_wider(all, first.explains, own.explains, 1.0 / usual_lead)) return false;
  mark_moving(first, own, frame);
  keep_motion(first, frame);
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
  constexpr int steps = 8;
  if (!context.history.has_previous()) return;
  Frame& frame = context.current;
  const Eigen::Isometry3d standing = context.previous.T_camera_world;
  std::vector<MapPointId> best_matches = frame.map_points;
  Eigen::Isometry3d best_pose = frame.T_camera_world;
  std::vector<bool> best = matched(frame);
  bool has_won = false;
  for (int k = 1; k <= steps; ++k) {
    frame.T_camera_world = Eigen::Translation3d(0.0, 0.0, -step_of_speeds * k) * standing;
    const int matches =
        context.matcher.match_previous(context.previous, static_cast<float>(context.settings.motion_window), frame);
    if (matches < context.settings.minimum_matches) continue;
    if (context.estimator.adjust(frame) < context.settings.minimum_matches / 2) continue;
    if (distance(frame.T_camera_world, best_pose) < same_motion) continue;
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

bool test_local_motion(TrackingContext& context, const Eigen::Isometry3d& began) {
  if (return_to_motion(context, began)) return true;
  constexpr double many = 0.3;  // of the matches
  const PoseProblem& problem = context.estimator.problem();
  const auto outliers = std::count(problem.inlier.begin(), problem.inlier.end(), std::uint8_t{0});
  if (outliers < 2 * context.settings.minimum_inliers ||
      static_cast<double>(outliers) < many * context.estimator.matches())
    return false;
  return choose_motion(context);
}

}  // namespace holdfast
