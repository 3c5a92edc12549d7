// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/report.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>

#include "holdfast/core/version.hpp"
#include "holdfast/evaluation/evaluation_plots.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/run/results.hpp"
#include "summary.hpp"

namespace holdfast {

namespace {

ReportSection section(std::string heading) {
  ReportSection section;
  section.heading = std::move(heading);
  return section;
}

ReportTable stage_report(const RunSummary& summary) {
  ReportTable table{
      "Time per frame in each stage", {"stage", "frames", "median ms", "p95 ms", "max ms", "share"}, {}, {}};
  for (const StageRow& row : summary.stages()) {
    table.rows.push_back({row.stage, std::to_string(row.frames), fixed_text(row.median * 1e3, 3),
                          fixed_text(row.p95 * 1e3, 3), fixed_text(row.maximum * 1e3, 3),
                          fixed_text(row.share * 100.0, 1) + " %"});
    table.bars.push_back(row.share);
  }
  return table;
}

ReportTable error_report(const Evaluation& evaluation) {
  ReportTable table{"Errors", {"", "RMSE", "S.D.", "max", "min", "mean", "median", "pairs"}, {}, {}};
  const auto add = [&](const std::string& name, const Statistics& s, std::size_t pairs, int decimals) {
    if (pairs == 0) return;
    table.rows.push_back({name, fixed_text(s.rmse, decimals), fixed_text(s.standard_deviation, decimals),
                          fixed_text(s.maximum, decimals), fixed_text(s.minimum, decimals),
                          fixed_text(s.mean, decimals), fixed_text(s.median, decimals), std::to_string(pairs)});
  };
  const RelativeError &time = evaluation.error_per_time, &way = evaluation.error_per_way;
  add("ATE [m]", evaluation.absolute_error, evaluation.poses.size(), 6);
  add("RPE per second [m]", time.translation, time.pairs, 6);
  add("RPE per second [deg]", time.rotation, time.pairs, 4);
  add("RPE per metre [m]", way.translation, way.pairs, 6);
  add("RPE per metre [deg]", way.rotation, way.pairs, 4);
  return table;
}

ReportTable thread_report(const ThreadRecord& threads) {
  ReportTable table{"Queues between threads",
                    {"before", "taken", "dropped", "longest", "of", "mean wait ms", "longest wait ms", "busy s"},
                    {},
                    {}};
  const auto add = [&](const std::string& name, const QueueCounts& queue, const std::string& busy) {
    table.rows.push_back({name, std::to_string(queue.taken), std::to_string(queue.dropped),
                          std::to_string(queue.longest), std::to_string(queue.capacity),
                          fixed_text(queue.mean_wait() * 1e3, 2), fixed_text(queue.wait_longest * 1e3, 2), busy});
  };
  add("tracking", threads.frames, "");
  for (const WorkerCounts& worker : threads.workers) add(worker.name, worker.queue, fixed_text(worker.busy_seconds, 2));
  return table;
}

ReportTable loop_report(const LoopRecord& record) {
  ReportTable table{"Loops",
                    {"at s", "saw again s", "points found", "fused", "way m", "moved by m", "turned by deg", "took ms"},
                    {},
                    {}};
  for (const LoopEvent& event : record.loops)
    table.rows.push_back({fixed_text(event.timestamp, 2), fixed_text(event.candidate_timestamp, 2),
                          std::to_string(event.loop.inliers), std::to_string(event.loop.points_fused),
                          fixed_text(event.loop.path_length, 2), fixed_text(event.loop.correction.metres, 4),
                          fixed_text(event.loop.correction.degrees, 2), fixed_text(event.loop.seconds * 1e3, 0)});
  return table;
}

ReportTable adjustment_report(const LoopRecord& record) {
  ReportTable table{
      "Full adjustments", {"keyframes", "points", "iterations", "seconds", "ms an iteration", "outcome"}, {}, {}};
  for (const FullAdjustmentSummary& summary : record.adjustments)
    table.rows.push_back({std::to_string(summary.keyframes), std::to_string(summary.points),
                          std::to_string(summary.bundle.iterations), fixed_text(summary.bundle.seconds, 2),
                          fixed_text(summary.seconds_per_iteration * 1e3, 0),
                          summary.applied          ? "applied"
                          : summary.stop_requested ? "stopped"
                                                   : "no solution"});
  return table;
}

ReportSection summary_section(const RunRecord& record) {
  ReportSection summary = section("Summary");
  summary.values = summary_rows(record);
  if (!record.failure.empty())
    summary.text = "The run ended before its time: " + record.failure;
  else
    summary.text = coverage_warning(record);
  if (record.was_interrupted) summary.text = "The run was interrupted; this is what was done until then.";
  return summary;
}

ReportSection warning_section(const Warnings& warnings) {
  ReportSection result = section("Warnings");
  for (const Diagnostic& warning : warnings) {
    const std::string place = warning.location.to_string();
    result.values.emplace_back(place.empty() ? "run" : place, warning.message);
  }
  return result;
}

/// How many frames have no pose, and what most of them suffered from; empty if all have one.
std::string missing_poses_text(const RunSummary& summary) {
  const std::uint64_t missing = summary.lost() + summary.count(TrackingStatus::waiting);
  if (missing == 0) return "";
  const std::vector<std::pair<TrackingFailure, std::size_t>> failures(summary.failures().begin(),
                                                                      summary.failures().end());
  const auto most = std::max_element(failures.begin(), failures.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  const std::string text = " Without a pose: " + counted(missing, "frame") + ", shaded red in the plots";
  if (most == failures.end() || most->second == 0) return text + ".";
  return text + "; the most frequent trouble is '" + to_string(most->first) + "' (" + counted(most->second, "frame") +
         ").";
}

ReportSection error_section(const Evaluation& evaluation, const RunSummary& summary) {
  ReportSection error = section("Trajectory");
  error.tables = {error_report(evaluation)};
  const AlignmentKind kind = evaluation.options.alignment;
  const std::string motion = kind == AlignmentKind::sim3   ? "Aligned with the truth by a motion with scale (sim3)"
                             : kind == AlignmentKind::none ? "Compared with the truth without alignment"
                                                           : "Aligned with the truth by a rigid motion (se3)";
  error.text = motion + " over all pairs; stamps paired one to one within 0.02 s." + missing_poses_text(summary);
  error.figures.push_back(
      {top_view_svg(evaluation), "The path by its error, and the true path as a thin line over it"});
  error.figures.push_back({error_over_time_svg(evaluation), "Absolute error over time"});
  for (int axis = 0; axis < 3; ++axis)
    error.figures.push_back({position_over_time_svg(evaluation, axis), axis == 2 ? "Position over time" : ""});
  for (int angle = 0; angle < 3; ++angle)
    error.figures.push_back({angle_over_time_svg(evaluation, angle),
                             angle < 2 ? ""
                                       : "Rotation over time: roll clockwise, pitch up and yaw to the right are "
                                         "positive; yaw is 0 in the first view of the truth"});
  return error;
}

ReportSection thread_section(const ThreadRecord& record) {
  ReportSection threads = section("Threads");
  threads.text = "Late frames: " + std::to_string(record.late) + ", at most by " +
                 fixed_text(record.largest_delay * 1e3, 1) +
                 " ms; keyframes put off: " + std::to_string(record.keyframes_deferred) + ".";
  threads.tables = {thread_report(record)};
  return threads;
}

ReportSection skipped_section(const std::vector<SkippedFrame>& skipped) {
  ReportTable table{"Frames left out", {"stamp", "reason"}, {}, {}};
  for (const SkippedFrame& frame : skipped) table.rows.push_back({fixed_text(frame.timestamp, 6), frame.reason});
  ReportSection result = section("Skipped frames");
  result.tables = {std::move(table)};
  return result;
}

/// "overlay/frame_000012.jpg" is of frame 12.
std::string frame_name(const std::string& picture) {
  const std::string stem = std::filesystem::path(picture).stem().string();
  return "frame " + std::to_string(std::stoull(stem.substr(stem.rfind('_') + 1)));
}

/// The pictures at the speed of the recording.
ReportSection picture_section(const RunRecord& record, const std::vector<std::string>& pictures) {
  ReportClip clip;
  clip.pictures = pictures;
  for (const std::string& picture : pictures) clip.names.push_back(frame_name(picture));
  const std::vector<double>& stamps = record.frame_stamps;
  constexpr double shortest = 0.01, longest = 1.0;  // s
  if (stamps.size() > 1)
    clip.interval =
        std::clamp((stamps.back() - stamps.front()) / static_cast<double>(pictures.size()), shortest, longest);
  clip.caption =
      "Masks are tinted by class and what moves is red; features from green (static) to red (moving), filled with a "
      "map "
      "point. The pictures are in the folder overlay beside this page.";
  ReportSection result = section("Pictures");
  result.clips = {std::move(clip)};
  return result;
}

std::vector<ReportHighlight> highlights(const RunRecord& record) {
  std::vector<ReportHighlight> result;
  if (record.evaluation)
    result.push_back({"ATE RMSE", fixed_text(record.evaluation->absolute_error.rmse * 1e3, 2) + " mm"});
  result.push_back({"coverage", percent_text(record.coverage()), has_low_coverage(record)});
  result.push_back({"tracking", fixed_text(record.summary.tracking().median * 1e3, 2) + " ms"});
  return result;
}

}  // namespace

std::string report_html(const RunRecord& record) { return report_html(record, {}); }

std::string report_html(const RunRecord& record, const std::vector<std::string>& pictures) {
  const RunSettings& run = record.configuration.run;
  Report report;
  report.title = record.source.name.empty() ? "Holdfast run" : "Holdfast: " + record.source.name;
  report.subtitle = record.configuration.file + ", seed " + std::to_string(run.seed) + ", " + choice_name(run.mode) +
                    ", version " HOLDFAST_VERSION ", commit " + build_commit() + "; " + machine_text();
  report.highlights = highlights(record);
  report.sections.push_back(summary_section(record));
  if (!record.warnings.empty()) report.sections.push_back(warning_section(record.warnings));
  if (!pictures.empty()) report.sections.push_back(picture_section(record, pictures));
  if (record.evaluation) report.sections.push_back(error_section(*record.evaluation, record.summary));
  report.sections.push_back(section("Stages"));
  report.sections.back().tables = {stage_report(record.summary)};
  if (!record.loops.loops.empty()) {
    report.sections.push_back(section("Loops"));
    report.sections.back().tables = {loop_report(record.loops), adjustment_report(record.loops)};
  }
  if (record.threads) report.sections.push_back(thread_section(*record.threads));
  if (!record.skipped.empty()) report.sections.push_back(skipped_section(record.skipped));
  report.sections.push_back(section("Configuration"));
  report.sections.back().preformatted = to_yaml(record.configuration);
  return to_html(report);
}

}  // namespace holdfast
