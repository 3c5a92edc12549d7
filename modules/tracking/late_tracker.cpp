// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/late_tracker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "holdfast/core/sensor.hpp"
#include "holdfast/geometry/pose_problem.hpp"

namespace holdfast {

void LateTracker::keep(const Frame& frame) {
  if (settings_.late_frames == 0) return;
  if (static_cast<int>(frames_.size()) >= settings_.late_frames) frames_.pop_front();
  frames_.push_back(frame);
  if (!features_have_depth(parts_.map.sensor())) frames_.back().static_probability.assign(frame.size(), 1.0F);
}

void LateTracker::finish(StageTimes& times, const std::atomic<bool>& stop) {
  if (frames_.empty()) return;
  const StageTimer timer(times, "late frames");
  std::vector<Frame*> frames;
  if (!parts_.history.empty())
    for (Frame& frame : frames_)
      if (frame.timestamp < parts_.history.last_timestamp() && !parts_.history.past_pose(frame.timestamp, parts_.map))
        frames.push_back(&frame);
  for (int pass = 0; pass < 2; ++pass) {
    std::reverse(frames.begin(), frames.end());
    locate(frames, stop);
  }
  frames_.clear();
}

void LateTracker::locate(std::vector<Frame*>& frames, const std::atomic<bool>& stop) {
  constexpr double near = 0.2;  // s
  Frame* located = nullptr;
  for (Frame* frame : frames) {
    if (stop) return;
    if (located != nullptr && std::abs(located->timestamp - frame->timestamp) > near) located = nullptr;
    if (!parts_.history.past_pose(frame->timestamp, parts_.map)) {
      if (!find_pose(located, *frame)) continue;
      ++located_;
    }
    located = frame;
  }
}

bool LateTracker::find_pose(Frame* neighbour, Frame& frame) {
  if (neighbour != nullptr && match_neighbour(*neighbour, frame) && fits_map(frame)) return true;
  constexpr std::size_t most = 6;
  std::vector<std::pair<double, KeyFrameId>> by_time;
  for (const KeyFrameId id : parts_.map.keyframes_by_age())
    by_time.emplace_back(std::abs(parts_.map.keyframe(id).frame.timestamp - frame.timestamp), id);
  std::stable_sort(by_time.begin(), by_time.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < std::min(most, by_time.size()); ++i)
    if (match_keyframe(by_time[i].second, frame) && fits_map(frame)) return true;
  return false;
}

bool LateTracker::match_neighbour(Frame& neighbour, Frame& frame) {
  frame.T_camera_world = neighbour.T_camera_world;
  const double radius = settings_.motion_window_retry * settings_.motion_window;
  odometry_.clear();
  return parts_.matcher.match_previous(neighbour, static_cast<float>(radius), frame) >= settings_.minimum_matches &&
         parts_.estimator.adjust_as_weighted(frame, odometry_) >= settings_.minimum_matches / 2;
}

bool LateTracker::match_keyframe(KeyFrameId keyframe, Frame& frame) {
  const Frame& of_keyframe = parts_.map.keyframe(keyframe).frame;
  if (parts_.matcher.match_keyframe(of_keyframe, frame) < settings_.minimum_matches) return false;
  frame.T_camera_world = of_keyframe.T_camera_world;
  const std::vector<MapPointId> matches = frame.map_points;
  odometry_.clear();
  parts_.estimator.adjust_as_weighted(frame, odometry_);  // builds the problem
  PoseProblem problem = parts_.estimator.problem();
  if (!geometry::find_pose(problem, geometry::PnpOptions{.seed = frame.index}).usable) return false;
  frame.map_points = matches;
  frame.T_camera_world = problem.T_camera_world;
  return parts_.estimator.adjust_as_weighted(frame, odometry_) >= settings_.minimum_matches / 2;
}

bool LateTracker::fits_map(Frame& frame) {
  int inliers = 0;
  for (const double window : {settings_.relocalisation_window, 1.0}) {
    parts_.matcher.match_local_map(static_cast<float>(window * settings_.local_map_window), frame);
    inliers = parts_.estimator.adjust_as_weighted(frame, odometry_);
  }
  const KeyFrameId reference = parts_.matcher.local_map().reference_keyframe();
  if (inliers < settings_.relocalisation_inliers ||
      inliers < settings_.relocalisation_chance * parts_.estimator.matches() ||
      parts_.estimator.position_deviation() > settings_.maximum_deviation ||
      parts_.map.find_keyframe(reference) == nullptr || !is_reachable(frame))
    return false;
  parts_.history.add_past(frame, reference, parts_.map);
  return true;
}

bool LateTracker::is_reachable(const Frame& frame) const {
  constexpr double tolerance = 0.1;       // m, of the poses
  std::array<const Frame*, 2> nearest{};  // before and after
  const auto submap = parts_.map.submap_of(parts_.matcher.local_map().reference_keyframe());
  for (const KeyFrameId id : parts_.map.keyframes_by_age()) {
    if (parts_.map.submap_of(id) != submap) continue;
    const Frame& other = parts_.map.keyframe(id).frame;
    const Frame*& side = nearest[other.timestamp < frame.timestamp ? 0 : 1];
    if (side == nullptr || std::abs(other.timestamp - frame.timestamp) < std::abs(side->timestamp - frame.timestamp))
      side = &other;
  }
  const Eigen::Vector3d position = frame.T_world_camera().translation();
  return std::all_of(nearest.begin(), nearest.end(), [&](const Frame* other) {
    if (other == nullptr) return true;
    const double distance = (other->T_world_camera().translation() - position).norm();
    return distance <= tolerance + settings_.relocalisation_speed * std::abs(other->timestamp - frame.timestamp);
  });
}

}  // namespace holdfast
