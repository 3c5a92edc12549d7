// SPDX-License-Identifier: BSD-3-Clause
#include "suspicions.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "holdfast/core/stamp_unit.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/evaluation/time_offset.hpp"
#include "relative_error.hpp"
#include "similarity_fit.hpp"

namespace holdfast {

namespace {

using PairIndices = std::vector<std::pair<std::size_t, std::size_t>>;

constexpr std::size_t fewest_judged = 10;  // pairs; fewer fit too much by chance
constexpr double explained = 0.3;          // a suspicion leaves less than this share of the true motion unexplained
constexpr double still = 1e-3;             // m
constexpr double degree = std::numbers::pi / 180.0;
constexpr double smallest_rotation = 3.0 * degree;  // over half a second

/// The poses of the associated pairs.
struct PairedPoses {
  std::vector<Eigen::Isometry3d> truth, estimate;
  std::vector<double> stamps;  ///< of the estimate [s]
};

PairedPoses paired(const Trajectory& truth, const Trajectory& estimate, const PairIndices& pairs) {
  PairedPoses poses;
  for (const auto& [true_index, index] : pairs) {
    poses.truth.push_back(truth[true_index].T_world_camera);
    poses.estimate.push_back(estimate[index].T_world_camera);
    poses.stamps.push_back(estimate[index].timestamp);
  }
  return poses;
}

Eigen::Matrix3Xd positions(const std::vector<Eigen::Isometry3d>& poses, bool inverted = false) {
  Eigen::Matrix3Xd result(3, poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i)
    result.col(static_cast<Eigen::Index>(i)) = (inverted ? poses[i].inverse() : poses[i]).translation();
  return result;
}

/// Largest distance of a position from the mean [m].
double extent_of(const Eigen::Matrix3Xd& positions) {
  return (positions.colwise() - positions.rowwise().mean()).colwise().norm().maxCoeff();
}

/// Rotation vectors of the motions from each pose to that half a second later [rad].
std::vector<Eigen::Vector3d> rotations_over_time(const std::vector<Eigen::Isometry3d>& poses,
                                                 const std::vector<double>& stamps, bool inverted = false) {
  constexpr double step = 0.5;  // s
  std::vector<Eigen::Vector3d> rotations;
  for (std::size_t i = 0, j = 0; i < stamps.size(); ++i) {
    while (j < stamps.size() && stamps[j] < stamps[i] + step) ++j;
    if (j == stamps.size()) break;
    if (stamps[j] > stamps[i] + 2.0 * step) continue;
    Eigen::Matrix3d from = poses[i].linear(), to = poses[j].linear();
    if (inverted) {
      from.transposeInPlace();
      to.transposeInPlace();
    }
    const Eigen::AngleAxisd rotation(Eigen::Matrix3d(from.transpose() * to));
    rotations.push_back(rotation.angle() * rotation.axis());
  }
  return rotations;
}

double rms(const std::vector<Eigen::Vector3d>& vectors) {
  double squares = 0.0;
  for (const Eigen::Vector3d& vector : vectors) squares += vector.squaredNorm();
  return vectors.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(vectors.size()));
}

/// RMS difference of two lists of equal length.
double rms_difference(std::vector<Eigen::Vector3d> a, const std::vector<Eigen::Vector3d>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return rms(a);
}

/// Whether rotations contradict that poses are inverted. Inverse poses of a camera that turns about one point lie on a
/// sphere whatever its positions are, so that positions alone can fit by chance.
bool rotations_contradict(const PairedPoses& poses, bool truth_inverted, bool estimate_inverted) {
  const std::vector<Eigen::Vector3d> turns = rotations_over_time(poses.truth, poses.stamps, truth_inverted);
  const double as_given =
      rms_difference(rotations_over_time(poses.truth, poses.stamps), rotations_over_time(poses.estimate, poses.stamps));
  const double inverted = rms_difference(turns, rotations_over_time(poses.estimate, poses.stamps, estimate_inverted));
  return rms(turns) < smallest_rotation || inverted >= 0.5 * as_given;
}

std::string stamp_suspicion(const std::string& name, const Trajectory& trajectory) {
  const std::string unit = stamp_unit_suspicion(stamps_of(trajectory));
  if (unit.empty()) return "";
  return "the time stamps of " + name + " " + unit + "; expected seconds, on which RPE and association depend";
}

std::string pair_suspicion(const Trajectory& truth, const Trajectory& estimate, const Evaluation& result) {
  const double tolerance = result.options.max_time_difference;
  const auto asked =
      static_cast<std::size_t>(std::count_if(estimate.begin(), estimate.end(), [&](const TimedPose& pose) {
        return pose.timestamp >= truth.front().timestamp - tolerance &&
               pose.timestamp <= truth.back().timestamp + tolerance;
      }));
  const std::size_t found = result.poses.size();
  if (asked < fewest_judged || 2 * found >= asked) return "";
  const double interval = median_interval(stamps_of(truth));
  std::string text = "only " + std::to_string(found) + " of " + counted(asked, "pose") + " of " +
                     result.options.estimate_name + " have a true pose within " + shortest_text(tolerance) + " s: ";
  if (interval > 2.0 * tolerance)
    text += "the truth has a pose every " + fixed_text(interval, 3) +
            " s. The errors are those of these poses alone; use a truth with more poses, or interpolate it before";
  else
    text +=
        "the truth has gaps, or its clock differs; try `holdfast evaluate --time-offset estimate`, or a larger "
        "--max-dt";
  return text;
}

std::string stillness_suspicion(const Eigen::Matrix3Xd& truth, const Eigen::Matrix3Xd& estimate,
                                const EvaluationOptions& options) {
  const double true_extent = extent_of(truth), estimated_extent = extent_of(estimate);
  if (std::max(true_extent, estimated_extent) < 20.0 * still) return "";
  if (true_extent < still)
    return "the truth never moves (its positions lie within " + fixed_text(1e3 * true_extent, 1) +
           " mm), but the estimate does: is " + options.truth_name +
           " of this recording, and did motion capture see the camera? The errors are the estimate's own motion";
  if (estimated_extent < still)
    return "the estimate never moves (its positions lie within " + fixed_text(1e3 * estimated_extent, 1) +
           " mm), but the truth does: are the positions of " + options.estimate_name + " in metres?";
  return "";
}

/// What mends the orientations of a left-handed frame, if they are left-handed, too: those of a camera whose axis k is
/// reversed have the rotation vector -F w, where F reverses the component k of the right one, w.
std::string mirror_remedy(const PairedPoses& poses) {
  const std::vector<Eigen::Vector3d> true_turns = rotations_over_time(poses.truth, poses.stamps);
  const std::vector<Eigen::Vector3d> turns = rotations_over_time(poses.estimate, poses.stamps);
  double least = rms_difference(true_turns, turns);
  char axis = '-';
  for (int k = 0; k < 3; ++k) {
    std::vector<Eigen::Vector3d> mirrored = true_turns;
    for (Eigen::Vector3d& turn : mirrored) {
      turn = -turn;
      turn[k] = -turn[k];
    }
    if (const double error = rms_difference(mirrored, turns); error < least) {
      least = error;
      axis = "xyz"[k];
    }
  }
  if (axis == '-') return "; their orientations agree: reverse the sign of one coordinate of the positions";
  return std::string("; mend it, or give `holdfast evaluate --mirror ") + axis +
         "` if it is the truth, and `--mirror-estimate " + axis + "` if it is the estimate";
}

/// Poses that fit far better mirrored or inverted than as they are.
std::string structure_suspicion(const PairedPoses& poses, const SimilarityFit& as_given,
                                const EvaluationOptions& options) {
  struct Alternative {
    double error;
    bool inverts_truth, inverts_estimate;
    std::string text;
  };
  const Eigen::Matrix3Xd truth = positions(poses.truth), estimate = positions(poses.estimate);
  const std::string inverse =
      " look inverted, as the pose of the world in the camera (T_camera_world); expected the "
      "pose of the camera in the world; mend them, or give `holdfast evaluate --invert ";
  std::array<Alternative, 3> alternatives = {
      {{fit_similarity(estimate, truth, true).relative(), false, false,
        options.truth_name + " and " + options.estimate_name +
            " look like mirror images of each other: one of them is in a left-handed frame, as those of Unity and "
            "Unreal" +
            mirror_remedy(poses)},
       {fit_similarity(estimate, positions(poses.truth, true)).relative(), true, false,
        "the poses of " + options.truth_name + inverse + "truth`"},
       {fit_similarity(positions(poses.estimate, true), truth).relative(), false, true,
        "the poses of " + options.estimate_name + inverse + "estimate`"}}};
  const auto best = std::min_element(alternatives.begin(), alternatives.end(),
                                     [](const Alternative& a, const Alternative& b) { return a.error < b.error; });
  if (best->error >= explained || best->error >= explained * as_given.relative()) return "";
  const bool is_inverse = best->inverts_truth || best->inverts_estimate;
  if (is_inverse && rotations_contradict(poses, best->inverts_truth, best->inverts_estimate)) return "";
  return best->text;
}

std::string scale_suspicion(const SimilarityFit& fit, const EvaluationOptions& options) {
  constexpr double accepted = 1.2, unit_tolerance = 1.15;
  if (options.alignment == AlignmentKind::sim3 || fit.relative() >= explained) return "";
  if (fit.scale > 1.0 / accepted && fit.scale < accepted) return "";
  if (fit.residual >= 0.5 * fit.rigid_residual) return "";
  struct Unit {
    double per_metre;
    const char* name;
    const char* option;
  };
  for (const Unit& unit : {Unit{1000.0, "millimetres", "mm"}, Unit{100.0, "centimetres", "cm"}}) {
    const auto is_near = [&](double scale) {
      return scale < unit.per_metre * unit_tolerance && scale > unit.per_metre / unit_tolerance;
    };
    const auto text = [&](const std::string& name, const char* which) {
      return "the positions of " + name + " look like " + unit.name + ", as they are " + shortest_text(unit.per_metre) +
             " times as large as the others; expected metres; give `holdfast evaluate "
             "--" +
             which + "-unit " + unit.option + "`";
    };
    if (is_near(fit.scale)) return text(options.truth_name, "truth");
    if (is_near(1.0 / fit.scale)) return text(options.estimate_name, "estimate");
  }
  return "the true motion is " + fixed_text(fit.scale, fit.scale < 0.1 ? 4 : 2) + " times as large as that of " +
         options.estimate_name +
         ": check the depth factor or the stereo baseline, the camera, and the unit of the truth; for an estimate of "
         "one camera, "
         "whose scale is arbitrary, use the alignment sim3";
}

std::string delay_suspicion(const Trajectory& truth, const Trajectory& estimate, const EvaluationOptions& options) {
  constexpr double smallest = 0.03;  // s; clocks of well-known recordings differ by 0.02 s
  constexpr double improvement = 0.5;
  constexpr double shortest_span = 5.0;  // in offsets; within a short time a motion resembles a later one
  constexpr double nearly_explained = 0.15, range = 5.0;
  const std::optional<TimeOffset> found = estimate_time_offset(truth, estimate, range);
  const double span = std::min(truth.back().timestamp, estimate.back().timestamp) -
                      std::max(truth.front().timestamp, estimate.front().timestamp);
  if (!found || std::abs(found->offset) < smallest || span < shortest_span * std::abs(found->offset) ||
      found->error >= improvement * found->error_without || found->error >= nearly_explained * found->spread)
    return "";
  const double offset = found->offset;
  return "the clocks of " + options.truth_name + " and " + options.estimate_name + " seem to differ by " +
         std::string(found->at_limit ? "at least " : "") + fixed_text(std::abs(offset), 3) + " s (" +
         (offset > 0.0 ? options.truth_name : options.estimate_name) +
         " is late): the error of the positions would be " + fixed_text(found->error, 4) + " m in place of " +
         fixed_text(found->error_without, 4) + " m; check the time stamps, or give `holdfast evaluate --time-offset " +
         (found->at_limit ? "estimate" : fixed_text(options.time_offset + offset, 3)) + "`";
}

/// Rotations that fit after one constant rotation of the tracked body: hand-eye calibration of rotations alone (Park
/// and Martin 1994, equation 12).
std::string body_suspicion(const PairedPoses& poses, const EvaluationOptions& options) {
  constexpr double smallest_turn = 10.0 * degree;
  const std::vector<Eigen::Vector3d> true_turns = rotations_over_time(poses.truth, poses.stamps);
  const std::vector<Eigen::Vector3d> turns = rotations_over_time(poses.estimate, poses.stamps);
  if (turns.size() < fewest_judged) return "";
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < turns.size(); ++i) correlation += true_turns[i] * turns[i].transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  // Rotations about one axis alone do not tell the constant one.
  if (svd.singularValues()(1) < 0.02 * svd.singularValues()(0)) return "";
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  const Eigen::Matrix3d truth_of_camera =
      svd.matrixU() * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
  std::vector<Eigen::Vector3d> turned = turns;
  for (Eigen::Vector3d& rotation : turned) rotation = truth_of_camera * rotation;
  const double motion = rms(true_turns), error = rms_difference(turns, true_turns);
  const double turn = Eigen::AngleAxisd(truth_of_camera).angle();
  if (turn < smallest_turn || motion < smallest_rotation ||
      rms_difference(turned, true_turns) >= explained * std::min(error, motion))
    return "";
  return "the orientations of " + options.truth_name + " are not those of the camera: they are turned by a constant " +
         fixed_text(turn / degree, 1) +
         " degrees, as those of markers, an IMU or a vehicle, or with other axes than x right, y down, z forward. RPE "
         "and rotations are not comparable; transform the truth to the camera (source.tum.truth_right does so)";
}

}  // namespace

std::vector<std::string> suspicions(const Trajectory& truth, const Trajectory& estimate, const PairIndices& pairs,
                                    const Evaluation& result) {
  std::vector<std::string> found;
  const auto add = [&](std::string text) {
    if (text.empty()) return false;
    found.push_back(std::move(text));
    return true;
  };
  const EvaluationOptions& options = result.options;
  const bool truth_counts_otherwise = add(stamp_suspicion(options.truth_name, truth));
  const bool estimate_counts_otherwise = add(stamp_suspicion(options.estimate_name, estimate));
  const bool are_seconds = !truth_counts_otherwise && !estimate_counts_otherwise;
  if (are_seconds) add(pair_suspicion(truth, estimate, result));
  if (pairs.size() < fewest_judged) return found;
  const PairedPoses poses = paired(truth, estimate, pairs);
  const Eigen::Matrix3Xd true_positions = positions(poses.truth), estimated_positions = positions(poses.estimate);
  if (add(stillness_suspicion(true_positions, estimated_positions, options))) return found;
  if (extent_of(true_positions) < still) return found;
  const SimilarityFit fit = fit_similarity(estimated_positions, true_positions);
  // Each of these would hide or feign those that follow.
  if (add(structure_suspicion(poses, fit, options))) return found;
  add(scale_suspicion(fit, options));
  if (are_seconds) add(delay_suspicion(truth, estimate, options));
  add(body_suspicion(poses, options));
  return found;
}

}  // namespace holdfast
