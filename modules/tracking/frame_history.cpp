// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/frame_history.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "holdfast/geometry/se3.hpp"

namespace holdfast {

void FrameHistory::add(const Frame& frame, KeyFrameId reference, const Map& map) {
  if (last_.has_previous) {
    last_.velocity = frame.T_camera_world * last_pose(map).inverse();
    last_.velocity_interval = frame.timestamp - last_timestamp();
    last_.has_velocity = true;
  }
  last_.has_previous = true;
  last_.T_camera_reference = Eigen::Isometry3d::Identity();
  last_.reference_scale = 1.0;
  if (reference.valid()) {
    last_.T_camera_reference = frame.T_camera_world * map.pose_of(reference).inverse();
    last_.reference_scale = map.scale_of(reference);
  }
  records_.push_back(record_of(frame.timestamp, reference, last_.T_camera_reference, last_.reference_scale));
}

bool FrameHistory::add_past(const Frame& frame, KeyFrameId reference, const Map& map) {
  const Eigen::Isometry3d T_camera_reference = frame.T_camera_world * map.pose_of(reference).inverse();
  const Record record = record_of(frame.timestamp, reference, T_camera_reference, map.scale_of(reference));
  const auto found = records_.begin() + (record_from(frame.timestamp) - records_.cbegin());
  if (found != records_.end() && found->timestamp == frame.timestamp) {
    *found = record;
    return false;
  }
  records_.insert(found, record);
  return true;
}

void FrameHistory::replace(double timestamp, const Eigen::Isometry3d& T_camera_world, const Map& map) {
  const auto found = records_.begin() + (record_from(timestamp) - records_.cbegin());
  const KeyFrameId reference = found->reference;
  *found = record_of(timestamp, reference, T_camera_world * map.pose_of(reference).inverse(), map.scale_of(reference));
}

std::optional<FrameHistory::PastPose> FrameHistory::past_pose(double timestamp, const Map& map) const {
  const auto found = record_from(timestamp);
  if (found == records_.end() || found->timestamp != timestamp || !map.submap_of(found->reference)) return std::nullopt;
  const KeyFrame* keyframe = map.find_keyframe(found->reference);
  return PastPose{pose_of(*found, map), keyframe != nullptr && keyframe->frame.timestamp == timestamp,
                  found->reference};
}

void FrameHistory::withdraw(double timestamp) { records_.erase(record_from(timestamp)); }

std::vector<FrameHistory::Record>::const_iterator FrameHistory::record_from(double timestamp) const {
  return std::lower_bound(records_.begin(), records_.end(), timestamp,
                          [](const Record& other, double time) { return other.timestamp < time; });
}

Eigen::Isometry3d FrameHistory::pose_of(const Record& record, const Map& map) {
  Eigen::Isometry3d T_camera_reference(record.R_camera_reference);
  T_camera_reference.translation() = record.t_camera_reference * map.scale_of(record.reference);
  return T_camera_reference * map.pose_of(record.reference);
}

FrameHistory::Mark FrameHistory::mark() const {
  Mark mark;
  mark.count_ = records_.size();
  mark.last_ = last_;
  return mark;
}

std::size_t FrameHistory::return_to(const Mark& mark) {
  const std::size_t forgotten = records_.size() - mark.count_;
  records_.erase(records_.begin() + static_cast<std::ptrdiff_t>(mark.count_), records_.end());
  last_ = mark.last_;
  return forgotten;
}

FrameHistory::Record FrameHistory::record_of(double timestamp, KeyFrameId reference,
                                             const Eigen::Isometry3d& T_camera_reference, double reference_scale) {
  return {timestamp, reference, Eigen::Quaternion<double, Eigen::DontAlign>(T_camera_reference.linear()),
          T_camera_reference.translation() / reference_scale};
}

void FrameHistory::became_keyframe(KeyFrameId keyframe, double timestamp) {
  if (records_.empty() || records_.back().timestamp != timestamp) return;
  records_.back() = {timestamp, keyframe};
  last_.T_camera_reference = Eigen::Isometry3d::Identity();
  last_.reference_scale = 1.0;
}

Eigen::Isometry3d FrameHistory::last_pose(const Map& map) const {
  const KeyFrameId reference = records_.back().reference;
  Eigen::Isometry3d T_camera_reference = last_.T_camera_reference;
  T_camera_reference.translation() *= map.scale_of(reference) / last_.reference_scale;
  return T_camera_reference * map.pose_of(reference);
}

Eigen::Isometry3d FrameHistory::predicted_step(double timestamp) const {
  if (!last_.has_velocity || last_.velocity_interval <= 0.0) return Eigen::Isometry3d::Identity();
  // Recordings leave frames out: the velocity is applied over the time that really passed, but not over gaps that are
  // much longer than the interval that it was measured in.
  constexpr double max_intervals = 4.0;
  constexpr double same_interval = 0.05;  // jitter of time stamps, as a share of the interval
  const double ratio = std::clamp((timestamp - last_timestamp()) / last_.velocity_interval, 0.0, max_intervals);
  return std::abs(ratio - 1.0) < same_interval ? last_.velocity
                                               : geometry::exp_se3(ratio * geometry::log_se3(last_.velocity));
}

Eigen::Isometry3d FrameHistory::extrapolate(double timestamp, double share) const {
  const double steps = last_.velocity_interval > 0.0 ? (timestamp - last_timestamp()) / last_.velocity_interval : 0.0;
  return geometry::exp_se3(share * steps * geometry::log_se3(last_.velocity));
}

std::uint32_t FrameHistory::main_submap(const Map& map) const {
  std::map<std::uint32_t, std::size_t> frames;
  for (const Record& record : records_)
    if (const std::optional<std::uint32_t> submap = map.submap_of(record.reference)) ++frames[*submap];
  const auto most =
      std::max_element(frames.begin(), frames.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == frames.end() ? 0 : most->first;
}

std::size_t FrameHistory::frames_left_out(const Map& map) const {
  const std::uint32_t submap = main_submap(map);
  return static_cast<std::size_t>(std::count_if(records_.begin(), records_.end(), [&](const Record& record) {
    return map.submap_of(record.reference) != submap;
  }));
}

Trajectory FrameHistory::trajectory(const Map& map) const {
  Trajectory trajectory;
  trajectory.reserve(records_.size());
  const std::uint32_t submap = main_submap(map);
  for (const Record& record : records_) {
    if (map.submap_of(record.reference) != submap) continue;
    trajectory.push_back({record.timestamp, pose_of(record, map).inverse()});
  }
  return trajectory;
}

}  // namespace holdfast
