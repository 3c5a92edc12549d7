// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/time_offset.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holdfast/core/stamp_unit.hpp"
#include "relative_error.hpp"
#include "similarity_fit.hpp"

namespace holdfast {

namespace {

constexpr std::size_t fewest_anchors = 20;
constexpr double longest_interpolated = 0.11;  // s

/// Positions of a trajectory at any time, interpolated linearly.
class PositionTrack {
 public:
  explicit PositionTrack(const Trajectory& trajectory)
      : trajectory_(trajectory), stamps_(stamps_of(trajectory)), longest_gap_(3.0 * median_interval(stamps_)) {}

  /// False outside the trajectory, and where its poses are farther apart than elsewhere.
  bool position_at(double time, Eigen::Vector3d& position) const {
    const auto above = std::upper_bound(stamps_.begin(), stamps_.end(), time);
    if (above == stamps_.begin() || above == stamps_.end()) return false;
    const auto index = static_cast<std::size_t>(above - stamps_.begin());
    const double gap = stamps_[index] - stamps_[index - 1];
    if (gap > longest_gap_) return false;
    const double share = (time - stamps_[index - 1]) / gap;
    position = (1.0 - share) * trajectory_[index - 1].T_world_camera.translation() +
               share * trajectory_[index].T_world_camera.translation();
    return true;
  }

 private:
  const Trajectory& trajectory_;
  std::vector<double> stamps_;
  double longest_gap_;
};

/// The error of an estimate as a function of the time offset. Its poses are compared with interpolated true positions;
/// where the truth has too few poses for that, true poses with interpolated positions of the estimate, whose noise is
/// smaller between two poses and draws the offset there.
class OffsetError {
 public:
  OffsetError(const Trajectory& truth, const Trajectory& estimate, double range)
      : interpolates_truth_(median_interval(stamps_of(truth)) <=
                            std::max(median_interval(stamps_of(estimate)), longest_interpolated)),
        track_(interpolates_truth_ ? truth : estimate) {
    constexpr std::size_t most_anchors = 1000;
    const double begin = std::max(truth.front().timestamp, estimate.front().timestamp) + range;
    const double end = std::min(truth.back().timestamp, estimate.back().timestamp) - range;
    for (const TimedPose& pose : interpolates_truth_ ? estimate : truth)
      if (pose.timestamp >= begin && pose.timestamp <= end) anchors_.push_back(pose);
    if (anchors_.size() <= most_anchors) return;
    std::vector<TimedPose> fewer;
    for (std::size_t i = 0; i < most_anchors; ++i) fewer.push_back(anchors_[i * anchors_.size() / most_anchors]);
    anchors_ = std::move(fewer);
  }

  std::size_t anchors() const { return anchors_.size(); }

  SimilarityFit operator()(double offset) const {
    Eigen::Matrix3Xd anchored(3, anchors_.size()), interpolated(3, anchors_.size());
    Eigen::Index count = 0;
    for (const TimedPose& pose : anchors_) {
      Eigen::Vector3d position;
      if (!track_.position_at(pose.timestamp + (interpolates_truth_ ? offset : -offset), position)) continue;
      anchored.col(count) = pose.T_world_camera.translation();
      interpolated.col(count++) = position;
    }
    anchored.conservativeResize(3, count);
    interpolated.conservativeResize(3, count);
    if (2 * static_cast<std::size_t>(count) < anchors_.size()) return {.residual = INFINITY};
    return interpolates_truth_ ? fit_similarity(anchored, interpolated) : fit_similarity(interpolated, anchored);
  }

 private:
  bool interpolates_truth_;
  PositionTrack track_;
  std::vector<TimedPose> anchors_;
};

/// The minimum of a function with one minimum in [begin, end], by golden section.
template <class Function>
double minimum_between(double begin, double end, const Function& function) {
  constexpr double ratio = 0.6180339887498949, tolerance = 1e-4;
  double left = end - ratio * (end - begin), right = begin + ratio * (end - begin);
  double at_left = function(left), at_right = function(right);
  while (end - begin > tolerance) {
    if (at_left <= at_right) {
      end = right;
      right = left;
      at_right = at_left;
      at_left = function(left = end - ratio * (end - begin));
    } else {
      begin = left;
      left = right;
      at_left = at_right;
      at_right = function(right = begin + ratio * (end - begin));
    }
  }
  return 0.5 * (begin + end);
}

}  // namespace

std::optional<TimeOffset> estimate_time_offset(const Trajectory& truth, const Trajectory& estimate, double range) {
  if (truth.size() < 2 || estimate.size() < 2) return std::nullopt;
  const double common = std::min(truth.back().timestamp, estimate.back().timestamp) -
                        std::max(truth.front().timestamp, estimate.front().timestamp);
  range = std::min(range, 0.25 * common);
  if (!(range > 0.0)) return std::nullopt;
  const OffsetError error(truth, estimate, range);
  if (error.anchors() < fewest_anchors) return std::nullopt;
  const SimilarityFit without = error(0.0);
  if (!std::isfinite(without.residual) || !(without.spread > 0.0)) return std::nullopt;

  constexpr double largest_step = 0.02;  // s; far below the time in which a camera turns back
  const int steps = static_cast<int>(std::ceil(range / largest_step));
  const double step = range / steps;
  int best = 0;
  double least = without.residual;
  for (int i = -steps; i <= steps; ++i)
    if (const double residual = error(i * step).residual; residual < least) {
      best = i;
      least = residual;
    }
  TimeOffset result{.error_without = without.residual, .spread = without.spread, .at_limit = std::abs(best) == steps};
  result.offset =
      minimum_between((best - 1) * step, (best + 1) * step, [&](double offset) { return error(offset).residual; });
  result.error = error(result.offset).residual;
  return result;
}

}  // namespace holdfast
