// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/inertial_starter.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>

#include "holdfast/core/imu_timeline.hpp"

namespace holdfast {

namespace {

constexpr double start_time = 2.0, start_time_of_one_camera = 5.0;  // [s]
constexpr double pose_spacing = 0.1, pose_spacing_of_one_camera = 0.2;
constexpr double largest_pose_gap = 1.0;
constexpr std::size_t fewest_poses = 10;
/// The same of a slow camera, which takes fewer frames than that in this time.
constexpr double longest_start_time = 15.0, largest_pose_gap_of_slow_camera = 5.0;
constexpr std::size_t fewest_poses_of_slow_camera = 6;
constexpr double start_interval = 0.25;  // between two attempts [s]
/// Poses of a slow camera have other views of other points than the one before, and not its errors.
constexpr double smallest_deviation = 0.002, largest_deviation = 0.01;  // [m]
constexpr double smallest_deviation_of_slow_camera = 0.005, largest_deviation_of_slow_camera = 0.02;

/// Which poses a start takes.
struct StartWindow {
  double time, spacing, largest_gap;  // [s]
  std::size_t fewest;                 // poses
  double earliest;                    // time stamp [s]
};

StartWindow start_window(bool scale_is_known, double now, bool is_slow) {
  const double time = scale_is_known ? start_time : start_time_of_one_camera;
  const double spacing = scale_is_known ? pose_spacing : pose_spacing_of_one_camera;
  if (is_slow)
    return {time, spacing, largest_pose_gap_of_slow_camera, fewest_poses_of_slow_camera, now - longest_start_time};
  return {time, spacing, largest_pose_gap, fewest_poses, now - time - largest_pose_gap};
}

/// Chooses poses of tracked frames, `spacing` apart, from the last one backwards until they are enough, or to the first
/// gap. The earliest one comes first.
Trajectory choose_poses(const std::vector<double>& tracked, const StartWindow& window,
                        const InertialStarter::PastPose& past_pose) {
  Trajectory chosen;
  for (auto stamp = tracked.rbegin(); stamp != tracked.rend() && *stamp > window.earliest; ++stamp) {
    if (!chosen.empty()) {
      const double last = chosen.back().timestamp;
      if (chosen.size() >= window.fewest && chosen.front().timestamp - last >= window.time) break;
      if (last - *stamp < window.spacing) continue;
      if (last - *stamp > window.largest_gap) break;
    }
    const std::optional<Eigen::Isometry3d> T_camera_world = past_pose(*stamp);
    if (T_camera_world) chosen.push_back({*stamp, T_camera_world->inverse()});
  }
  std::reverse(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace

/// Keeps the stamps of the last seconds, and one before.
void InertialStarter::begin_frame(double timestamp) {
  frames_.push_back(timestamp);
  const double begin = timestamp - longest_start_time;
  while (frames_.size() > 2 && frames_[1] < begin) frames_.erase(frames_.begin());
}

void InertialStarter::add(const std::vector<ImuSample>& samples) { append_imu(samples_, samples); }

std::optional<FoundInertialStart> InertialStarter::found(const PastPose& past_pose) {
  const double now = frames_.back();
  tracked_.push_back(now);
  if (now < next_start_) return std::nullopt;
  forget_before(now - longest_start_time - largest_pose_gap);
  const bool is_slow = is_slow_camera();
  const StartWindow window = start_window(scale_is_known_, now, is_slow);
  const Trajectory poses = choose_poses(tracked_, window, past_pose);
  if (poses.size() < window.fewest || now - poses.front().timestamp < window.time) return std::nullopt;
  next_start_ = now + start_interval;
  InertialStartSearch search;
  search.estimate_scale = !scale_is_known_;
  search.smallest_deviation = is_slow ? smallest_deviation_of_slow_camera : smallest_deviation;
  search.largest_deviation = is_slow ? largest_deviation_of_slow_camera : largest_deviation;
  return find_inertial_start(poses, samples_, imu_, search);
}

void InertialStarter::clear() {
  samples_.clear();
  tracked_.clear();
  next_start_ = 0.0;
}

/// Whether the last frames are too few for a start, even if all of them had a pose.
bool InertialStarter::is_slow_camera() const {
  const double now = frames_.back(), begin = now - start_window(scale_is_known_, now, false).time;
  const auto later = std::count_if(frames_.begin(), frames_.end(), [&](double stamp) { return stamp >= begin; });
  return frames_.front() < begin && static_cast<std::size_t>(later) < fewest_poses;
}

/// Keeps one measurement before.
void InertialStarter::forget_before(double earliest) {
  std::erase_if(tracked_, [&](double stamp) { return stamp < earliest; });
  const auto first_kept = std::find_if(samples_.begin(), samples_.end(),
                                       [&](const ImuSample& sample) { return sample.timestamp >= earliest; });
  if (first_kept != samples_.begin()) samples_.erase(samples_.begin(), std::prev(first_kept));
}

}  // namespace holdfast
