// SPDX-License-Identifier: BSD-3-Clause
#include "summary.hpp"

#include <algorithm>

#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/evaluation/report.hpp"
#include "holdfast/evaluation/statistics.hpp"
#include "holdfast/perturbation/perturbation_settings.hpp"
#include "holdfast/plugin/parameter_table.hpp"
#include "holdfast/run/results.hpp"

namespace holdfast {

namespace {

const char* advice(TrackingFailure failure) {
  switch (failure) {
    case TrackingFailure::no_depth:
      return "Check the depth factor of the source, which gives the metres of a depth value, and that the depth images "
             "belong to the colour images.";
    case TrackingFailure::few_features:
      return "Check that the images are sharp and bright, `count` of the features, and that masks do not cover "
             "everything.";
    case TrackingFailure::few_matches:
    case TrackingFailure::few_inliers:
      return "Check that `camera` is the camera of this recording and the depth factor of the source fits; then how "
             "fast the camera moves, and whether filters or masks leave enough of the static world.";
    case TrackingFailure::little_parallax:
      return "One camera begins its map when it has moved sideways or forward by some hundredths of the distance of "
             "what it sees; turning on the spot is not enough.";
    case TrackingFailure::no_mask:
      return "Check that the segmenter gives results.";
    case TrackingFailure::weak_start:
      return "One camera needs a start with texture at several depths, and masks that cover the people in view.";
    case TrackingFailure::exchanged_pair:
      return "The matches of the pairs lie on the wrong side: exchange the left and right images in the settings of "
             "the source (the folders `colour` and `right`, or those of the recording).";
    case TrackingFailure::none:
      break;
  }
  return "";
}

std::string masks_text(const MaskCounts& masks, const std::vector<double>& ages) {
  std::string text = std::to_string(masks.found);
  if (masks.found < masks.segmented) text += " of " + std::to_string(masks.segmented) + " frames that were segmented";
  if (ages.empty()) return text;
  return text + ", " + fixed_text(median(ages) * 1e3, 0) + " ms old when they came (median), " +
         fixed_text(percentile(ages, 95.0) * 1e3, 0) + " ms (p95)";
}

/// "noise 20 grey levels, dropped 0.5"; empty without perturbation.
std::string perturbation_text(const Configuration& configuration) {
  std::string text;
  const std::vector<Parameter> parameters = ParameterTable<PerturbationSettings>().parameters();
  for (const auto& [name, strength] : perturbation_strengths(configuration)) {
    text += (text.empty() ? "" : ", ") + name + " " + shortest_text(strength);
    for (const Parameter& parameter : parameters)
      if (parameter.name == name && !parameter.unit_name.empty()) text += " " + parameter.unit_name;
  }
  return text;
}

/// Advice for a camera with depth that was lost once, to the end of the run, although it saw features: the recording
/// may go on in another place. Empty if nothing suggests that.
std::string advice_to_restart(const RunRecord& record) {
  constexpr double suggested = 2.0;         // s, of tracking.restart_time
  constexpr double share_of_missing = 0.8;  // of all frames without a pose, those after the last one with a pose
  if (!features_have_depth(record.sensor) || record.localised_only || record.trajectory.empty() ||
      record.frame_stamps.empty() ||
      section_settings<TrackingSettings>(record.configuration, "tracking").restart_time > 0.0)
    return "";
  const auto& failures = record.summary.failures();
  const auto count_of = [&](TrackingFailure failure) {
    const auto found = failures.find(failure);
    return found == failures.end() ? std::uint64_t{0} : found->second;
  };
  const double last_pose = record.trajectory.back().timestamp;
  const double lost_for = *std::max_element(record.frame_stamps.begin(), record.frame_stamps.end()) - last_pose;
  const auto lost = static_cast<double>(std::count_if(record.frame_stamps.begin(), record.frame_stamps.end(),
                                                      [&](double stamp) { return stamp > last_pose; }));
  const auto missing = static_cast<double>(record.frame_stamps.size() - record.trajectory.size());
  const auto unmatched =
      static_cast<double>(count_of(TrackingFailure::few_matches) + count_of(TrackingFailure::few_inliers));
  if (lost_for <= suggested || lost < share_of_missing * missing || unmatched < share_of_missing * lost) return "";
  return " The camera was lost " + fixed_text(last_pose - record.frame_stamps.front(), 1) +
         " s after the first frame, and not found again in the " + fixed_text(lost_for, 1) +
         " s that followed. If these show another place, `--set tracking.restart_time=" + fixed_text(suggested, 0) +
         "` helps: a camera that is lost for so many seconds begins a new submap there, and the submap with "
         "most frames is the result.";
}

std::string reasons_text(const RunSummary& summary) {
  std::string text;
  for (const auto& [reason, frames] : summary.reasons())
    text += (text.empty() ? " (frames not good: " : ", ") + std::to_string(frames) + " " + to_string(reason);
  return text.empty() ? "" : text + ")";
}

std::string pair_text(const PairEstimate& pair) {
  std::string rotation;
  for (int axis = 0; axis < 3; ++axis)
    rotation += (axis == 0 ? "" : ", ") + fixed_text(1e3 * pair.errors.rotation[axis], 2);
  std::string text = "calibration corrected: right camera turned by " + rotation + " mrad about x, y, z, focal ratio " +
                     fixed_text(pair.errors.focal_ratio, 5);
  if (pair.errors.radial != 0.0) text += ", radial distortion " + fixed_text(pair.errors.radial, 5);
  if (pair.errors.decentring != 0.0) text += ", decentring " + fixed_text(pair.errors.decentring, 5);
  if (pair.shift_sigma > 0.0)
    text += ", columns shifted by " + fixed_text(pair.shift, 2) + " +- " + fixed_text(pair.shift_sigma, 2) + " px";
  return text;
}

}  // namespace

std::vector<std::pair<std::string, double>> perturbation_strengths(const Configuration& configuration) {
  return section_settings<PerturbationSettings>(configuration, "perturbation").strengths();
}

std::string percent_text(double share) { return fixed_text(share * 100.0, 2) + " %"; }

std::vector<std::pair<std::string, std::string>> summary_rows(const RunRecord& record) {
  const RunSummary& s = record.summary;
  std::vector<std::pair<std::string, std::string>> rows;
  rows.emplace_back("sequence", record.source.name);
  if (record.sensor != Sensor::rgbd) rows.emplace_back("sensor", sensor_name(record.sensor));
  rows.emplace_back("frames",
                    std::to_string(s.frames()) + " of " + std::to_string(record.frames_expected) +
                        (record.skipped.empty() ? "" : ", " + std::to_string(record.skipped.size()) + " skipped"));
  if (const RepeatedImages& repeated = record.repeated_images; repeated.frames > 0)
    rows.emplace_back("repeated images",
                      counted(repeated.frames, "frame") + ", for up to " + fixed_text(repeated.longest, 2) + " s");
  if (const std::string perturbation = perturbation_text(record.configuration); !perturbation.empty())
    rows.emplace_back("perturbation", perturbation);
  rows.emplace_back("coverage",
                    percent_text(record.coverage()) + " (" + counted(record.trajectory.size(), "pose") + ")");
  rows.emplace_back("lost", counted(s.lost(), "frame") + ", recovered " + counted(s.recovered(), "time") +
                                ", relocalised " + std::to_string(s.relocalised()));
  const LossRecord& losses = record.losses;
  if (losses.tracked_backwards > 0)
    rows.back().second += ", " + counted(losses.tracked_backwards, "frame") + " tracked backwards";
  if (losses.located_late > 0)
    rows.back().second += ", " + counted(losses.located_late, "frame") + " located in the finished map";
  if (losses.placed_by_inertia > 0)
    rows.back().second += ", " + counted(losses.placed_by_inertia, "frame") + " placed by inertia at the end";
  if (losses.withdrawn > 0) rows.back().second += ", " + counted(losses.withdrawn, "pose") + " withdrawn";
  if (losses.submaps > 0)
    rows.back().second += ", " + counted(losses.submaps, "new submap") + " begun, " +
                          counted(losses.left_out, "frame") + " left out with those that nothing joined";
  const std::uint64_t odometry = s.count(TrackingFallback::odometry);
  const std::uint64_t masked = s.count(TrackingFallback::masked_features);
  const std::uint64_t dense = s.count(TrackingFallback::dense_depth);
  if (odometry + masked + dense > 0)
    rows.emplace_back("fallback", counted(odometry, "frame") + " by odometry, " + std::to_string(masked) +
                                      " by masked features, " + std::to_string(dense) + " by dense depth");
  if (const std::uint64_t inertial = s.count(TrackingStatus::inertial); inertial > 0)
    rows.emplace_back("inertia", counted(inertial, "frame") + " bridged by inertial measurements");
  if (const std::uint64_t degraded = s.count(HealthState::degraded); degraded > 0)
    rows.emplace_back("health", counted(degraded, "frame") + " degraded" + reasons_text(s));
  rows.emplace_back("map", counted(record.map_keyframes, "keyframe") + ", " + counted(record.map_points, "point") +
                               "; " + fixed_text(s.mean_inliers(), 0) + " inliers a frame");
  if (record.surface && !record.surface->empty())
    rows.emplace_back("surface", fixed_text(record.surface->area(), 1) + " m^2 in " +
                                     counted(record.surface->triangles.size(), "triangle") + "; " +
                                     fixed_text(1e-6 * static_cast<double>(record.surface_bytes), 0) + " MB");
  if (record.readout != 0.0)
    rows.emplace_back("rolling shutter", "rows are exposed during " + fixed_text(1e3 * record.readout, 1) + " ms");
  if (record.pair && record.pair->errors != PairErrors()) rows.emplace_back("stereo pair", pair_text(*record.pair));
  if (record.configuration.loop_detector.name != "none")
    rows.emplace_back("loops", std::to_string(record.loops.loops.size()) + " closed");
  if (record.evaluation) {
    const Evaluation& e = *record.evaluation;
    rows.emplace_back(
        "ATE RMSE", fixed_text(e.absolute_error.rmse, 6) + " m (" + std::string(to_string(e.options.alignment)) + ", " +
                        counted(e.poses.size(), "pair") + ", path " + fixed_text(e.path_length, 2) + " m" +
                        (e.options.truth_frame == "raw" ? "" : ", truth transformed to the camera") + ")");
    if (e.error_per_time.pairs > 0)
      rows.emplace_back("RPE per second", fixed_text(e.error_per_time.translation.rmse, 6) + " m, " +
                                              fixed_text(e.error_per_time.rotation.rmse, 4) + " deg");
  } else {
    rows.emplace_back("accuracy", "unknown, " + record.no_evaluation);
  }
  const StageRow tracking = s.tracking();
  rows.emplace_back("tracking", fixed_text(tracking.median * 1e3, 2) + " ms a frame (median), " +
                                    fixed_text(tracking.p95 * 1e3, 2) + " ms (p95)");
  if (record.masks.segmented > 0) rows.emplace_back("masks", masks_text(record.masks, record.mask_ages));
  if (record.threads) {
    const ThreadRecord& threads = *record.threads;
    rows.emplace_back("frame to result", fixed_text(median(threads.delays) * 1e3, 2) + " ms (median), " +
                                             fixed_text(percentile(threads.delays, 95.0) * 1e3, 2) + " ms (p95), " +
                                             percent_text(threads.late_share()) + " above 33 ms; " +
                                             std::to_string(threads.frames.dropped) + " dropped, " +
                                             counted(threads.keyframes_deferred, "keyframe") + " put off");
  }
  rows.emplace_back("start to first pose",
                    record.start_seconds > 0.0 ? fixed_text(record.start_seconds, 3) + " s" : "no frame got a pose");
  rows.emplace_back("whole run", fixed_text(record.total_seconds, 1) + " s, peak memory " +
                                     fixed_text(static_cast<double>(record.peak_memory) / 1e6, 0) + " MB");
  return rows;
}

bool has_low_coverage(const RunRecord& record) { return record.coverage() < record.configuration.run.minimum_coverage; }

std::string coverage_warning(const RunRecord& record) {
  if (!has_low_coverage(record) || record.was_interrupted || !record.failure.empty()) return "";
  std::string text = std::to_string(record.trajectory.size()) + " of " + counted(record.frames_expected, "frame") +
                     (record.trajectory.size() == 1 ? " has" : " have") + " a pose (" +
                     percent_text(record.coverage()) + "), less than run.minimum_coverage " +
                     percent_text(record.configuration.run.minimum_coverage) + ".";
  TrackingFailure commonest = TrackingFailure::none;
  std::uint64_t frames = 0;
  for (const auto& [failure, count] : record.summary.failures())
    if (failure != TrackingFailure::none && count > frames) {
      commonest = failure;
      frames = count;
    }
  if (record.skipped.size() > frames)
    return text + " The commonest trouble: " + counted(record.skipped.size(), "frame") +
           " skipped. Check the images; run.json says why each was skipped.";
  if (frames == 0) return text + " Check the camera and the depth factor.";
  text += advice_to_restart(record);
  return text + " The commonest trouble: " + to_string(commonest) + " (" + counted(frames, "frame") + "). " +
         advice(commonest);
}

std::string summary_text(const RunRecord& record) {
  std::string text = stage_table(record.summary) + "\n";
  for (const auto& [name, value] : summary_rows(record)) {
    std::string label = name;
    label.resize(std::max<std::size_t>(label.size() + 1, 21), ' ');
    text += label + value + "\n";
  }
  return text;
}

}  // namespace holdfast
