// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/trajectory.hpp"
#include "holdfast/evaluation/alignment.hpp"
#include "holdfast/evaluation/coverage.hpp"
#include "holdfast/evaluation/statistics.hpp"

namespace holdfast {

/// How an estimate is compared with the truth; docs/evaluation.md defines each.
struct EvaluationOptions {
  AlignmentKind alignment = AlignmentKind::se3;
  double max_time_difference = 0.02;  ///< stamps further apart than this are no pair [s]
  double time_step = 1.0;             ///< of the relative error per time [s]
  double path_step = 1.0;             ///< of the relative error per way [m]
  std::string truth_name = "truth";   ///< for messages, tables and plots
  std::string estimate_name = "estimate";
};

/// A pose of the estimate and the truth at its time.
struct EvaluatedPose {
  double timestamp = 0.0;                              ///< of the estimate [s]
  double truth_timestamp = 0.0;                        ///< [s]
  Eigen::Vector3d truth = Eigen::Vector3d::Zero();     ///< position in the truth's world [m]
  Eigen::Vector3d estimate = Eigen::Vector3d::Zero();  ///< aligned position [m]
  double error = 0.0;                                  ///< their distance [m]
};

/// A position at a time, in the truth's world.
struct TimedPosition {
  double timestamp = 0.0;                              ///< [s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
};

/// Relative pose error (Sturm et al. 2012, section V-A) over pairs of poses i, j of the estimate.
///
/// With E = inv(T_i) T_j of the estimate (translations times the scale of the alignment, which is 1 except for sim3)
/// and G the same of the truth at the nearest stamps, the error is E inv(G): the order of the benchmark's own tool, not
/// that of its paper. A pose further than twice the truth's median interval from its nearest truth takes no part.
///
/// Per time: for every i, j is the pose nearest to t_i + time_step; pairs whose j is the last pose are left out. Both
/// as in the benchmark's tool, so at a gap of the estimate a pair may span more or less than time_step. Per way: the
/// true path is the sum of the distances between all successive poses of the truth, so it does not depend on the
/// estimate. For every i, j is the first later pose at which the true path since i is path_step or more. Pairs that
/// overshoot by more than a tenth (across a gap of the estimate) are left out, so that all speak about the same way.
struct RelativeError {
  Statistics translation;         ///< length of the error's translation [m]
  Statistics rotation;            ///< angle of the error's rotation [deg]
  std::size_t pairs = 0;          ///< 0: no pair is that far apart; the statistics are NaN then
  std::size_t uneven_pairs = 0;   ///< per time: pairs whose time step is off by more than a tenth
  std::size_t omitted_pairs = 0;  ///< per way: pairs left out because they overshoot by more than a tenth
};

/// Everything that evaluate() found. Statistics are over `poses` for the absolute error.
struct Evaluation {
  EvaluationOptions options;
  std::size_t truth_poses = 0;
  std::size_t estimate_poses = 0;
  double path_length = 0.0;  ///< of the truth, straight from pair to pair [m]
  double duration = 0.0;     ///< from the first to the last pair [s]
  TrajectoryAlignment alignment;
  std::vector<EvaluatedPose> poses;  ///< the pairs, in order of time
  Statistics absolute_error;         ///< ATE [m]: distances of the aligned positions
  RelativeError error_per_time;
  RelativeError error_per_way;
  std::optional<Coverage> coverage;           ///< none: unknown, because the frames were not given
  std::vector<TimedPosition> truth_track;     ///< the whole truth between the first and the last pose of the estimate
  std::vector<TimedPosition> estimate_track;  ///< all poses of the estimate, aligned
};

/// Compares an estimate with the truth. Stamps need not be sorted; of several poses with one stamp the last one counts,
/// poses that are not finite are left out. Pairs are made by associate_stamps() within max_time_difference. Throws
/// Error when options are out of range, when there are fewer than 3 pairs (the message says why) or the list of frames
/// is empty.
Evaluation evaluate(const Trajectory& truth, const Trajectory& estimate, const EvaluationOptions& options = {},
                    const std::optional<std::vector<double>>& frame_stamps = std::nullopt);

/// A table to read on a terminal, ends with a newline. States alignment, pairing and number of pairs.
std::string to_text(const Evaluation& evaluation);
/// The same figures in full precision; coverage is null when unknown, a statistic of no pairs is null.
std::string to_json(const Evaluation& evaluation);
/// The same figures in full precision as rows "quantity,statistic,value,unit".
std::string to_csv(const Evaluation& evaluation);

/// What was compared, for whoever draws it: {"truth": [[t, x, y, z], ...], "estimate": the same, aligned, "error": [[t,
/// metres], ...]} with stamps in milliseconds' precision and positions in a tenth of one [s, m].
std::string to_tracks_json(const Evaluation& evaluation);

/// A picture of the aligned estimate on the truth, seen along the axis in which the truth extends least, both axes to
/// one scale. Self-contained SVG.
std::string top_view_svg(const Evaluation& evaluation);
/// A picture of the absolute error over time with its RMSE. Shaded are frames without a pose, or,
/// where the frames are unknown, times without a pair. Self-contained SVG.
std::string error_over_time_svg(const Evaluation& evaluation);

}  // namespace holdfast
