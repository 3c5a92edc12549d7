// SPDX-License-Identifier: BSD-3-Clause
#include "relative_error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace holdfast {

namespace {

constexpr double uneven_share = 0.1;  // of the step

/// Place of the stamp nearest to `time` in a sorted list that is not empty; of two equally near ones the earlier.
std::size_t nearest_stamp(const std::vector<double>& sorted, double time) {
  const auto above = std::lower_bound(sorted.begin(), sorted.end(), time);
  const auto index = static_cast<std::size_t>(above - sorted.begin());
  if (index == 0) return 0;
  if (index == sorted.size()) return index - 1;
  return std::abs(sorted[index - 1] - time) <= std::abs(sorted[index] - time) ? index - 1 : index;
}

/// The length of the path to each pose [m].
std::vector<double> way_to_each(const Trajectory& trajectory) {
  std::vector<double> way(trajectory.size(), 0.0);
  for (std::size_t k = 1; k < trajectory.size(); ++k)
    way[k] = way[k - 1] +
             (trajectory[k].T_world_camera.translation() - trajectory[k - 1].T_world_camera.translation()).norm();
  return way;
}

double angle_of(const Eigen::Matrix3d& rotation) {
  return std::acos(std::clamp((rotation.trace() - 1.0) / 2.0, -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

/// Collects the errors of pairs and sums them up.
class Collector {
 public:
  Collector(const Trajectory& truth, const Trajectory& estimate, double scale)
      : truth_(truth), estimate_(estimate), scale_(scale) {}

  void add(std::size_t i, std::size_t j, std::size_t truth_i, std::size_t truth_j) {
    Eigen::Isometry3d moved = estimate_[i].T_world_camera.inverse() * estimate_[j].T_world_camera;
    moved.translation() *= scale_;
    const Eigen::Isometry3d truly_moved = truth_[truth_i].T_world_camera.inverse() * truth_[truth_j].T_world_camera;
    const Eigen::Isometry3d error = moved * truly_moved.inverse();
    translation_.push_back(error.translation().norm());
    rotation_.push_back(angle_of(error.linear()));
  }

  void finish(RelativeError& result) const {
    result.pairs = translation_.size();
    result.translation = statistics_of(translation_);
    result.rotation = statistics_of(rotation_);
  }

 private:
  const Trajectory& truth_;
  const Trajectory& estimate_;
  double scale_;
  std::vector<double> translation_, rotation_;
};

}  // namespace

NearestTruth::NearestTruth(const std::vector<double>& truth_stamps, const std::vector<double>& estimate_stamps,
                           double max_time_difference) {
  constexpr double slow_truth = 1.0 / 16.0;  // s
  std::vector<double> intervals;
  for (std::size_t i = 1; i < truth_stamps.size(); ++i) intervals.push_back(truth_stamps[i] - truth_stamps[i - 1]);
  const double interval = median(intervals);
  const double tolerance = interval > slow_truth ? max_time_difference : 2.0 * interval;
  for (const double stamp : estimate_stamps) {
    const std::size_t nearest = nearest_stamp(truth_stamps, stamp);
    index_.push_back(nearest);
    near_.push_back(std::abs(truth_stamps[nearest] - stamp) <= tolerance);
  }
}

std::vector<double> stamps_of(const Trajectory& trajectory) {
  std::vector<double> stamps;
  stamps.reserve(trajectory.size());
  for (const TimedPose& pose : trajectory) stamps.push_back(pose.timestamp);
  return stamps;
}

RelativeError relative_error_per_time(const Trajectory& truth, const Trajectory& estimate, const NearestTruth& nearest,
                                      double time_step, double scale) {
  const std::vector<double> stamps = stamps_of(estimate);
  Collector collector(truth, estimate, scale);
  RelativeError result;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const std::size_t j = nearest_stamp(stamps, stamps[i] + time_step);
    if (j == i || j + 1 == stamps.size() || !nearest.is_near(i) || !nearest.is_near(j)) continue;
    collector.add(i, j, nearest[i], nearest[j]);
    if (std::abs(stamps[j] - stamps[i] - time_step) > uneven_share * time_step) ++result.uneven_pairs;
  }
  collector.finish(result);
  return result;
}

RelativeError relative_error_per_way(const Trajectory& truth, const Trajectory& estimate, const NearestTruth& nearest,
                                     double path_step, double scale) {
  const std::vector<double> way = way_to_each(truth);
  Collector collector(truth, estimate, scale);
  RelativeError result;
  // The path length never decreases with time, so that the end of the pair never moves back.
  std::size_t j = 0;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    if (!nearest.is_near(i)) continue;
    while (j < estimate.size() && (!nearest.is_near(j) || way[nearest[j]] - way[nearest[i]] < path_step)) ++j;
    if (j == estimate.size()) break;
    if (way[nearest[j]] - way[nearest[i]] > (1.0 + uneven_share) * path_step)
      ++result.omitted_pairs;
    else
      collector.add(i, j, nearest[i], nearest[j]);
  }
  collector.finish(result);
  return result;
}

SegmentError segment_error(const Trajectory& truth, const Trajectory& estimate, const NearestTruth& nearest,
                           double scale) {
  constexpr double shortest = 100.0, longest = 800.0;  // m; in steps of the shortest
  constexpr std::size_t stride = 10;
  const std::vector<double> way = way_to_each(truth);
  SegmentError result;
  for (double length = shortest; length <= longest; length += shortest) {
    SegmentError::OfLength of_length{.length = length};
    std::size_t j = 0;
    for (std::size_t i = 0; i < estimate.size(); i += stride) {
      if (!nearest.is_near(i)) continue;
      while (j < estimate.size() && (!nearest.is_near(j) || way[nearest[j]] - way[nearest[i]] <= length)) ++j;
      if (j == estimate.size()) break;
      Eigen::Isometry3d moved = estimate[i].T_world_camera.inverse() * estimate[j].T_world_camera;
      moved.translation() *= scale;
      const Eigen::Isometry3d truly_moved =
          truth[nearest[i]].T_world_camera.inverse() * truth[nearest[j]].T_world_camera;
      const Eigen::Isometry3d error = moved.inverse() * truly_moved;
      ++of_length.segments;
      of_length.translation += 100.0 * error.translation().norm() / length;
      of_length.rotation += angle_of(error.linear()) / length;
    }
    if (of_length.segments == 0) break;
    result.segments += of_length.segments;
    result.translation += of_length.translation;
    result.rotation += of_length.rotation;
    of_length.translation /= static_cast<double>(of_length.segments);
    of_length.rotation /= static_cast<double>(of_length.segments);
    result.lengths.push_back(of_length);
  }
  if (result.segments == 0) return result;
  result.translation /= static_cast<double>(result.segments);
  result.rotation /= static_cast<double>(result.segments);
  return result;
}

}  // namespace holdfast
