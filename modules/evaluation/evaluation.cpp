// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "holdfast/core/association.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/stamp_unit.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "relative_error.hpp"
#include "scale_drift.hpp"
#include "suspicions.hpp"

namespace holdfast {

namespace {

constexpr std::size_t fewest_pairs = 3;

void check_options(const EvaluationOptions& options) {
  const auto check = [](const char* name, double value) {
    if (!(value > 0.0) || !std::isfinite(value))
      throw Error(std::string(name) + " is " + shortest_text(value) + "; expected a positive number");
  };
  check("the largest time difference of a pair [s]", options.max_time_difference);
  check("the time step of the relative error [s]", options.time_step);
  check("the path step of the relative error [m]", options.path_step);
  if (!std::isfinite(options.time_offset))
    throw Error("the time offset [s] is " + shortest_text(options.time_offset) + "; expected a finite number");
}

std::string describe(const std::string& name, const std::vector<double>& stamps) {
  if (stamps.empty()) return name + " holds no pose";
  return name + " holds " + std::to_string(stamps.size()) + (stamps.size() == 1 ? " pose" : " poses") + " from " +
         fixed_text(stamps.front(), 6) + " to " + fixed_text(stamps.back(), 6) + " s";
}

/// The remedy for stamps that are not seconds; empty where they may be.
std::string unit_advice(const std::string& name, const std::vector<double>& stamps) {
  const std::string suspicion = stamp_unit_suspicion(stamps);
  return suspicion.empty() ? "" : "The stamps of " + name + " " + suspicion + ". ";
}

[[noreturn]] void throw_too_few_pairs(const EvaluationOptions& options, std::size_t pairs,
                                      const std::vector<double>& truth, const std::vector<double>& estimate) {
  std::string message = "found " + std::to_string(pairs) + (pairs == 1 ? " pair" : " pairs") +
                        " of stamps closer than " + shortest_text(options.max_time_difference) +
                        " s; expected at least 3. " + describe(options.truth_name, truth) + ", " +
                        describe(options.estimate_name, estimate) + ". ";
  if (truth.size() < fewest_pairs || estimate.size() < fewest_pairs)
    message += "Give trajectories of at least 3 poses.";
  else if (const std::string unit =
               unit_advice(options.truth_name, truth) + unit_advice(options.estimate_name, estimate);
           !unit.empty())
    message += unit.substr(0, unit.size() - 1);
  else if (truth.back() < estimate.front() || estimate.back() < truth.front())
    message +=
        "They do not overlap in time: are both of the same sequence, in seconds of the same clock? "
        "If only the clocks differ, give `holdfast evaluate --time-offset " +
        fixed_text(options.time_offset + truth.front() - estimate.front(), 3) +
        "`, the difference of the first stamps.";
  else
    message += "They overlap in time: allow a larger difference of stamps if the truth was recorded less often.";
  throw Error(message);
}

/// The truth from shortly before the first to shortly after the last pose of the estimate.
Trajectory track_between(const Trajectory& truth, double begin, double end) {
  Trajectory track;
  for (const TimedPose& pose : truth)
    if (pose.timestamp >= begin && pose.timestamp <= end) track.push_back(pose);
  return track;
}

/// The pose of the estimate in the world frame of the truth.
TimedPose aligned(const TimedPose& pose, const TrajectoryAlignment& alignment) {
  TimedPose result = pose;
  result.T_world_camera.linear() = alignment.rotation * pose.T_world_camera.linear();
  result.T_world_camera.translation() = alignment.apply(pose.T_world_camera.translation());
  return result;
}

}  // namespace

Evaluation evaluate(const Trajectory& truth_as_given, const Trajectory& estimate_as_given,
                    const EvaluationOptions& options, const std::optional<std::vector<double>>& frame_stamps) {
  check_options(options);
  const Trajectory truth = sort_and_clean(truth_as_given);
  Trajectory estimate = sort_and_clean(estimate_as_given);
  const std::vector<double> stamps_as_given = stamps_of(estimate);
  for (TimedPose& pose : estimate) pose.timestamp += options.time_offset;
  const std::vector<double> truth_stamps = stamps_of(truth);
  const std::vector<double> estimate_stamps = stamps_of(estimate);
  const auto pairs = associate_stamps(truth_stamps, estimate_stamps, options.max_time_difference);
  if (pairs.size() < fewest_pairs) throw_too_few_pairs(options, pairs.size(), truth_stamps, estimate_stamps);

  Evaluation result;
  result.options = options;
  result.truth_poses = truth.size();
  result.estimate_poses = estimate.size();

  Eigen::Matrix3Xd true_positions(3, pairs.size()), estimated_positions(3, pairs.size());
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    true_positions.col(static_cast<Eigen::Index>(k)) = truth[pairs[k].first].T_world_camera.translation();
    estimated_positions.col(static_cast<Eigen::Index>(k)) = estimate[pairs[k].second].T_world_camera.translation();
  }
  result.alignment = align_positions(estimated_positions, true_positions, options.alignment);

  std::vector<double> errors;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    EvaluatedPose pose;
    pose.timestamp = stamps_as_given[pairs[k].second];
    pose.truth_timestamp = truth_stamps[pairs[k].first];
    pose.truth = true_positions.col(static_cast<Eigen::Index>(k));
    pose.estimate = result.alignment.apply(estimated_positions.col(static_cast<Eigen::Index>(k)));
    pose.error = (pose.estimate - pose.truth).norm();
    errors.push_back(pose.error);
    if (k > 0) result.path_length += (pose.truth - result.poses.back().truth).norm();
    result.poses.push_back(pose);
    result.mean_up -= truth[pairs[k].first].T_world_camera.linear().col(1) / static_cast<double>(pairs.size());
  }
  result.duration = result.poses.back().timestamp - result.poses.front().timestamp;
  result.absolute_error = statistics_of(errors);
  const double scale = result.alignment.scale;
  const NearestTruth nearest(truth_stamps, estimate_stamps, options.max_time_difference);
  result.error_per_time = relative_error_per_time(truth, estimate, nearest, options.time_step, scale);
  result.error_per_way = relative_error_per_way(truth, estimate, nearest, options.path_step, scale);
  result.segment_error = segment_error(truth, estimate, nearest, scale);
  if (options.alignment == AlignmentKind::sim3) result.scale_drift = scale_drift(result.poses);

  if (frame_stamps) {
    std::vector<double> frames = *frame_stamps;
    std::erase_if(frames, [](double stamp) { return !std::isfinite(stamp); });
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    if (frames.empty()) throw Error("the list of frames is empty; expected the stamps of the sequence's frames");
    result.coverage = measure_coverage(frames, stamps_as_given);
  }

  result.truth_track = track_between(truth, estimate_stamps.front(), estimate_stamps.back());
  for (const TimedPose& pose : estimate) result.estimate_track.push_back(aligned(pose, result.alignment));
  for (std::size_t i = 0; i < stamps_as_given.size(); ++i) result.estimate_track[i].timestamp = stamps_as_given[i];
  for (std::string& text : suspicions(truth, estimate, pairs, result)) result.warnings.push_back({{}, std::move(text)});
  return result;
}

}  // namespace holdfast
