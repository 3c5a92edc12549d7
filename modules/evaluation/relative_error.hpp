// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "holdfast/evaluation/evaluation.hpp"

namespace holdfast {

/// For every pose of the estimate its nearest ground truth, if it is near enough; see RelativeError.
class NearestTruth {
 public:
  NearestTruth(const std::vector<double>& truth_stamps, const std::vector<double>& estimate_stamps,
               double max_time_difference);
  bool is_near(std::size_t estimate_index) const { return near_[estimate_index]; }
  std::size_t operator[](std::size_t estimate_index) const { return index_[estimate_index]; }

 private:
  std::vector<std::size_t> index_;
  std::vector<char> near_;
};

/// See RelativeError. Both trajectories sorted, each stamp once, at least 2 poses each; `nearest` belongs to them;
/// `scale` multiplies the translations of the estimate.
RelativeError relative_error_per_time(const Trajectory& truth, const Trajectory& estimate, const NearestTruth& nearest,
                                      double time_step, double scale);
RelativeError relative_error_per_way(const Trajectory& truth, const Trajectory& estimate, const NearestTruth& nearest,
                                     double path_step, double scale);

/// See SegmentError; the same requirements.
SegmentError segment_error(const Trajectory& truth, const Trajectory& estimate, const NearestTruth& nearest,
                           double scale);

/// The stamps of a trajectory.
std::vector<double> stamps_of(const Trajectory& trajectory);

}  // namespace holdfast
