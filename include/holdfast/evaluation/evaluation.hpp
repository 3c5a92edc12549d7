// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/core/warning.hpp"
#include "holdfast/evaluation/alignment.hpp"
#include "holdfast/evaluation/coverage.hpp"
#include "holdfast/evaluation/statistics.hpp"

namespace holdfast {

/// Options of the comparison of an estimate with the ground truth; docs/evaluation.md defines them.
struct EvaluationOptions {
  AlignmentKind alignment = AlignmentKind::se3;
  double max_time_difference = 0.02;  ///< maximum difference of associated time stamps [s]
  double time_step = 1.0;             ///< interval of the relative error per time [s]
  double path_step = 1.0;             ///< path length of the relative error per distance [m]
  std::string truth_name = "truth";   ///< for messages, tables and plots
  double time_offset = 0.0;           ///< added to the stamps of the estimate, for association and RPE [s]
  std::string truth_frame = "raw";    ///< "raw" as recorded, or "transformed" to the camera; for the results alone
  std::string estimate_name = "estimate";
};

/// A pose of the estimate with its associated ground truth.
struct EvaluatedPose {
  double timestamp = 0.0;                              ///< of the estimate [s]
  double truth_timestamp = 0.0;                        ///< [s]
  Eigen::Vector3d truth = Eigen::Vector3d::Zero();     ///< position in the world frame of the ground truth [m]
  Eigen::Vector3d estimate = Eigen::Vector3d::Zero();  ///< aligned position [m]
  double error = 0.0;                                  ///< their distance [m]
};

/// Relative pose error (Sturm et al. 2012, section V-A) over pairs of poses i, j of the estimate.
///
/// error = E inv(G) with E = inv(T_i) T_j of the estimate (translations multiplied by the scale of the alignment, which
/// is 1 except for sim3) and G = inv(T_i) T_j of the ground truth at the nearest stamps. This is the order of the
/// benchmark's tool, not that of its paper. A pose is ignored if its nearest ground truth is farther than twice the
/// median interval of the ground truth; for a ground truth with fewer than 16 poses per second, which that tool does
/// not expect, farther than max_time_difference.
///
/// Per time: for every i, j is the pose nearest to t_i + time_step; pairs whose j is the last pose are excluded. Both
/// rules are those of the benchmark's tool; at a gap of the estimate a pair may therefore span more or less than
/// time_step. A pose is never compared with itself. Per distance: the true path length is the sum of the distances
/// between all consecutive poses of the ground truth, so that it does not depend on the estimate. For every i, j is the
/// first later pose at which the true path length since i is at least path_step. Pairs that exceed path_step by more
/// than a tenth (across a gap of the estimate) are excluded, so that all pairs have a comparable length.
struct RelativeError {
  Statistics translation;         ///< norm of the error's translation [m]
  Statistics rotation;            ///< angle of the error's rotation [deg]
  std::size_t pairs = 0;          ///< number of pairs; the statistics are NaN if it is 0
  std::size_t uneven_pairs = 0;   ///< per time: pairs whose interval deviates by more than a tenth
  std::size_t omitted_pairs = 0;  ///< per distance: excluded pairs that exceed path_step by more than a tenth
};

/// The errors of the KITTI odometry benchmark (Geiger et al. 2012, section 3.1, as its tool computes them): over
/// segments of 100, 200, ... 800 m of true path that begin at every tenth pose, the error inv(E) G of the relative pose
/// (E of the estimate, G of the truth, from the first to the last pose of the segment), divided by the length of the
/// segment.
struct SegmentError {
  /// The error over all segments of one length.
  struct OfLength {
    double length = 0.0;       ///< [m]
    std::size_t segments = 0;  ///< at least 1
    double translation = 0.0;  ///< mean [% of the length]
    double rotation = 0.0;     ///< mean [deg/m]
  };
  std::vector<OfLength> lengths;  ///< lengths with at least one segment, increasing
  std::size_t segments = 0;       ///< of all lengths; 0 if the path is shorter than 100 m
  double translation = 0.0;       ///< mean over all segments [% of the length]
  double rotation = 0.0;          ///< the same [deg/m]
};

/// Scale drift of an estimate along the path, for the alignment sim3. The pairs are divided into ten windows of equal
/// length of true path; the scale of a window is that of its own similarity alignment divided by that of the whole,
/// above 1 where the estimate is too small. A window with fewer than ten pairs, or without motion, is left out. An
/// estimate whose error is not small compared with the motion in a window has scales below their true values there.
struct ScaleDrift {
  /// A tenth of the true path.
  struct Window {
    double begin = 0.0, end = 0.0;  ///< stamps of its first and its last pair [s]
    std::size_t pairs = 0;
    double scale = 1.0;  ///< relative to the whole
  };
  std::vector<Window> windows;  ///< in temporal order; with fewer than two the drift is undefined
  double drift = 0.0;           ///< scale of the last window / scale of the first - 1
  double spread = 0.0;          ///< largest scale / smallest - 1
};

/// Result of evaluate(). The statistics of the absolute error are over `poses`.
struct Evaluation {
  EvaluationOptions options;
  std::size_t truth_poses = 0;
  std::size_t estimate_poses = 0;
  double path_length = 0.0;  ///< of the ground truth, as a polyline through the pairs [m]
  double duration = 0.0;     ///< from the first to the last pair [s]
  TrajectoryAlignment alignment;
  std::vector<EvaluatedPose> poses;  ///< associated pairs, in temporal order
  Statistics absolute_error;         ///< ATE [m]: distances of the aligned positions
  RelativeError error_per_time;
  RelativeError error_per_way;
  SegmentError segment_error;
  std::optional<ScaleDrift> scale_drift;  ///< empty unless the alignment is sim3 and the drift is defined
  std::optional<Coverage> coverage;       ///< empty if the frames were not given
  Trajectory truth_track;                 ///< ground truth between the first and the last pose of the estimate
  Trajectory estimate_track;              ///< all poses of the estimate, aligned: in the world frame of the truth
  /// Mean over the compared true poses of the direction that is up in the image (-y of the camera), in the frame of the
  /// truth. Near 1 in length for a camera that is carried upright: then it is opposite to gravity.
  Eigen::Vector3d mean_up = Eigen::Vector3d::Zero();
  /// Warnings about causes of errors other than the estimate, each a clause with its remedy (core/warning.hpp): the
  /// unit of stamps or lengths, a late clock, inverted, mirrored or unmoved poses, a truth of another body, poses
  /// without a truth.
  Warnings warnings;
};

/// Compares an estimate with the ground truth. Stamps need not be sorted; of several poses with the same stamp the last
/// one is used, and poses that are not finite are ignored. Pairs are associated by associate_stamps() within
/// max_time_difference, after time_offset has been added to those of the estimate; results have the stamps as given.
/// Throws Error if an option is out of range, if there are fewer than 3 pairs (the message states
/// the reason), or if the list of frames is empty.
Evaluation evaluate(const Trajectory& truth, const Trajectory& estimate, const EvaluationOptions& options = {},
                    const std::optional<std::vector<double>>& frame_stamps = std::nullopt);

/// Formats the result as a table for a terminal, with alignment, association and number of pairs; ends with a newline.
std::string to_text(const Evaluation& evaluation);
/// Formats the result as JSON in full precision; an unknown coverage and statistics without pairs are null.
std::string to_json(const Evaluation& evaluation);
/// Formats the result as CSV in full precision, rows "quantity,statistic,value,unit".
std::string to_csv(const Evaluation& evaluation);

/// Formats the compared trajectories for plotting: {"truth": [[t, x, y, z], ...], "estimate": the same, aligned,
/// "error": [[t, metres], ...], "truth_rotation": [[qx, qy, qz, qw], ...], "estimate_rotation": the same, aligned}; the
/// rotations belong to the positions of the same row. Time stamps [s] have a precision of 1 ms, positions [m] of 0.1
/// mm, quaternions five decimals.
std::string to_tracks_json(const Evaluation& evaluation);

/// Plots the aligned estimate and the ground truth with equal scales, projected along an axis of the ground truth: the
/// vertical one (from the upright direction of the camera), or, if the path is nearly flat in this view, the axis of
/// its smallest extent. Self-contained SVG.
std::string top_view_svg(const Evaluation& evaluation);
/// Plots the absolute error over time with its RMSE. Frames without a pose are shaded, or times without a pair if the
/// frames are unknown. Self-contained SVG.
std::string error_over_time_svg(const Evaluation& evaluation);

}  // namespace holdfast
