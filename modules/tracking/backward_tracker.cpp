// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/backward_tracker.hpp"

#include <algorithm>
#include <utility>

#include "holdfast/geometry/se3.hpp"
#include "holdfast/tracking/inertia.hpp"

namespace holdfast {

void BackwardTracker::keep(const Frame& frame, int max_count, StageTimes& times) {
  if (max_count == 0) return;
  if (located_) finish(times);  // lost again, before the last loss was over
  if (static_cast<int>(frames_.size()) >= max_count) frames_.pop_front();
  frames_.push_back(frame);
}

void BackwardTracker::finish(StageTimes& times) {
  if (!located_) return clear();
  const StageTimer timer(times, "backwards");
  if (anchor_ || begin(true)) track_kept(static_cast<int>(frames_.size()));
  clear();
}

void BackwardTracker::keyframe_added(KeyFrameId keyframe) {
  constexpr std::uint64_t soon = 3;  // frames
  if (!located_ || keyframe_.valid()) return;
  if (last_index_ <= located_->index + soon) keyframe_ = keyframe;
}

void BackwardTracker::clear() {
  frames_.clear();
  located_.reset();
  after_.clear();
  keyframe_ = reference_ = KeyFrameId();
  anchor_.reset();
  motion_.reset();
  failures_ = 0;
}

void BackwardTracker::track(const Frame& located, StageTimes& times) {
  if (frames_.empty()) return;
  const StageTimer timer(times, "backwards");
  last_index_ = located.index;
  if (!located_)
    located_ = located;
  else if (!anchor_)
    after_.push_back({located.timestamp, located.T_world_camera()});
  if (anchor_ || begin(false)) track_kept(settings_.backward_steps);
}

bool BackwardTracker::begin(bool now) {
  const auto mask_time = static_cast<std::uint64_t>(settings_.backward_mask_frames);
  if (!now && last_index_ < located_->index + mask_time) return false;
  const KeyFrame* keyframe = parts_.map.find_keyframe(keyframe_);
  anchor_ = keyframe != nullptr ? keyframe->frame : *located_;
  map_time_ = anchor_->timestamp;
  const auto next = std::find_if(after_.begin(), after_.end(),
                                 [&](const TimedPose& pose) { return pose.timestamp > anchor_->timestamp; });
  if (next != after_.end())
    motion_ = FrameMotion{geometry::log_se3(anchor_->T_camera_world * next->T_world_camera),
                          next->timestamp - anchor_->timestamp};
  return true;
}

void BackwardTracker::track_kept(int max_count) {
  for (int i = 0; i < max_count && !frames_.empty(); ++i) {
    Frame frame = std::move(frames_.back());
    frames_.pop_back();
    if (!find_pose(frame)) {
      check_earlier_pose(frame);
      if (++failures_ < settings_.backward_patience) continue;
      for (auto earlier = frames_.rbegin(); earlier != frames_.rend(); ++earlier) check_earlier_pose(*earlier);
      return clear();
    }
    failures_ = 0;
    add_pose(frame);
    const Eigen::Isometry3d step = frame.T_camera_world * anchor_->T_world_camera();
    motion_ = FrameMotion{geometry::log_se3(step), anchor_->timestamp - frame.timestamp};
    anchor_ = std::move(frame);
  }
  if (frames_.empty()) clear();
}

Eigen::Isometry3d BackwardTracker::predicted_pose(double timestamp) const {
  if (!motion_) return anchor_->T_camera_world;
  return motion_->during(anchor_->timestamp - timestamp) * anchor_->T_camera_world;
}

void BackwardTracker::add_pose(const Frame& frame) {
  const auto earlier = parts_.history.past_pose(frame.timestamp, parts_.map);
  // A keyframe's pose has been adjusted together with its points.
  const bool keeps = earlier && earlier->is_keyframe &&
                     !contradicts_inertia(frame.T_camera_world * earlier->T_camera_world.inverse(), 0.0, settings_);
  if (!keeps && parts_.history.add_past(frame, reference_, parts_.map)) ++tracked_;
}

void BackwardTracker::check_earlier_pose(const Frame& frame) {
  const auto earlier = parts_.history.past_pose(frame.timestamp, parts_.map);
  if (!earlier || !motion_) return;
  const Eigen::Isometry3d change = earlier->T_camera_world * predicted_pose(frame.timestamp).inverse();
  if (!contradicts_inertia(change, anchor_->timestamp - frame.timestamp, settings_)) return;
  parts_.history.withdraw(frame.timestamp);
  ++withdrawn_;
}

bool BackwardTracker::find_pose(Frame& frame) {
  const Eigen::Isometry3d predicted = predicted_pose(frame.timestamp);
  const auto match = [&](double radius) {
    frame.T_camera_world = predicted;
    const int matches = parts_.matcher.match_previous_features(*anchor_, static_cast<float>(radius), frame, odometry_);
    return matches >= settings_.minimum_matches &&
           parts_.estimator.adjust_as_weighted(frame, odometry_) >= settings_.minimum_matches / 2;
  };
  if (!match(settings_.motion_window) && !match(settings_.motion_window_retry * settings_.motion_window)) return false;
  parts_.matcher.match_local_map(static_cast<float>(settings_.local_map_window), frame);
  const int inliers = parts_.estimator.adjust_as_weighted(frame, odometry_);
  const KeyFrameId reference = parts_.matcher.local_map().reference_keyframe();
  if (reference.valid()) reference_ = reference;
  if (!reference_.valid() || parts_.map.find_keyframe(reference_) == nullptr) return false;
  // As after a loss, twice as many have to agree: what forward tracking refused is not to be taken for less.
  const int required = 2 * settings_.minimum_inliers;
  const auto in_map =
      std::count_if(frame.map_points.begin(), frame.map_points.end(), [](MapPointId point) { return point.valid(); });
  if (inliers < required || is_refuted(frame, predicted, inliers)) return false;
  if (in_map >= required)
    map_time_ = frame.timestamp;
  else if (map_time_ - frame.timestamp > settings_.odometry_time ||
           parts_.moving_world.is_view_filled(frame, reference_))
    return false;
  return true;
}

bool BackwardTracker::is_refuted(const Frame& frame, const Eigen::Isometry3d& predicted, int inliers) {
  if (parts_.estimator.position_deviation() > settings_.maximum_deviation ||
      parts_.moving_world.contradicts_depth(frame, inliers, true, reference_))
    return true;
  if (!motion_) return false;
  const Eigen::Isometry3d change = frame.T_camera_world * predicted.inverse();
  return contradicts_inertia(change, anchor_->timestamp - frame.timestamp, settings_);
}

}  // namespace holdfast
