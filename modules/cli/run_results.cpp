// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/cli/run_results.hpp"

#include <sys/utsname.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "holdfast/core/simd.hpp"
#include "holdfast/core/version.hpp"
#include "holdfast/evaluation/report.hpp"
#include "holdfast/evaluation/statistics.hpp"

namespace holdfast {

namespace {

using Json = nlohmann::ordered_json;

std::string number(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", decimals, value);
  return text;
}

std::string percent(double share) { return number(share * 100.0, 2) + " %"; }

std::string processor() {
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

std::string system_name() {
  utsname name{};
  return uname(&name) == 0 ? std::string(name.sysname) + " " + name.release + " " + name.machine : "unknown";
}

/// The pairs "what, value" that the terminal, the report and nobody else needs formatted.
std::vector<std::pair<std::string, std::string>> summary_rows(const RunRecord& record) {
  const RunSummary& s = record.summary;
  std::vector<std::pair<std::string, std::string>> rows;
  rows.emplace_back("sequence", record.source.name);
  rows.emplace_back("frames",
                    std::to_string(s.frames()) + " of " + std::to_string(record.frames_expected) +
                        (record.skipped.empty() ? "" : ", " + std::to_string(record.skipped.size()) + " skipped"));
  rows.emplace_back("coverage",
                    percent(record.coverage()) + " (" + std::to_string(record.trajectory.size()) + " poses)");
  rows.emplace_back("lost", std::to_string(s.lost()) + " frames, recovered " + std::to_string(s.recovered()) +
                                " times, relocalised " + std::to_string(s.relocalised()));
  rows.emplace_back("map", std::to_string(record.map_keyframes) + " keyframes, " + std::to_string(record.map_points) +
                               " points; " + number(s.mean_inliers(), 0) + " inliers a frame");
  if (record.configuration->loop_detector.name != "none")
    rows.emplace_back("loops", std::to_string(record.loops.loops.size()) + " closed");
  if (record.evaluation) {
    const Evaluation& e = *record.evaluation;
    rows.emplace_back("ATE RMSE", number(e.absolute_error.rmse, 6) + " m (se3, " + std::to_string(e.poses.size()) +
                                      " pairs, path " + number(e.path_length, 2) + " m)");
    if (e.error_per_time.pairs > 0)
      rows.emplace_back("RPE per second", number(e.error_per_time.translation.rmse, 6) + " m, " +
                                              number(e.error_per_time.rotation.rmse, 4) + " deg");
  } else {
    rows.emplace_back("error", "unknown: " + record.no_evaluation);
  }
  const StageRow tracking = s.tracking();
  rows.emplace_back("tracking", number(tracking.median * 1e3, 2) + " ms a frame (median), " +
                                    number(tracking.p95 * 1e3, 2) + " ms (p95)");
  if (!record.mask_ages.empty())
    rows.emplace_back("masks", std::to_string(record.mask_ages.size()) + ", " +
                                   number(median(record.mask_ages) * 1e3, 0) + " ms old when they came (median), " +
                                   number(percentile(record.mask_ages, 95.0) * 1e3, 0) + " ms (p95)");
  if (record.threads) {
    const ThreadRecord& threads = *record.threads;
    rows.emplace_back("frame to result", number(median(threads.delays) * 1e3, 2) + " ms (median), " +
                                             number(percentile(threads.delays, 95.0) * 1e3, 2) + " ms (p95), " +
                                             percent(threads.late_share()) + " above 33 ms; " +
                                             std::to_string(threads.frames.dropped) + " dropped, " +
                                             std::to_string(threads.keyframes_deferred) + " keyframes put off");
  }
  rows.emplace_back("start to first pose", number(record.start_seconds, 3) + " s");
  rows.emplace_back("whole run", number(record.total_seconds, 1) + " s, peak memory " +
                                     number(static_cast<double>(record.peak_memory) / 1e6, 0) + " MB");
  return rows;
}

Json stage_json(const StageRow& row) {
  return {{"stage", row.stage},       {"frames", row.frames}, {"median_s", row.median}, {"p95_s", row.p95},
          {"maximum_s", row.maximum}, {"total_s", row.total}, {"share", row.share}};
}

Json queue_json(const QueueCounts& queue) {
  return {{"capacity", queue.capacity},       {"taken", queue.taken},
          {"dropped", queue.dropped},         {"longest", queue.longest},
          {"mean_wait_s", queue.mean_wait()}, {"longest_wait_s", queue.wait_longest}};
}

Json threads_json(const ThreadRecord& threads) {
  Json json = {{"frames", queue_json(threads.frames)},
               {"late_frames", threads.late},
               {"latest_s", threads.latest},
               {"keyframes_deferred", threads.keyframes_deferred}};
  if (!threads.delays.empty())
    json["frame_to_result"] = {{"median_s", median(threads.delays)},
                               {"p95_s", percentile(threads.delays, 95.0)},
                               {"maximum_s", percentile(threads.delays, 100.0)},
                               {"share_above_33_ms", threads.late_share()}};
  Json& workers = json["workers"] = Json::array();
  for (const WorkerCounts& worker : threads.workers)
    workers.push_back({{"name", worker.name}, {"busy_s", worker.busy_seconds}, {"queue", queue_json(worker.queue)}});
  return json;
}

Json loops_json(const LoopRecord& record) {
  Json json;
  json["keyframes"] = record.counts.keyframes;
  json["points_fused"] = record.counts.points_fused;
  Json& verdicts = json["verdicts"] = Json::object();
  for (std::size_t i = 0; i < loop_verdicts; ++i)
    verdicts[loop_verdict_name(static_cast<LoopVerdict>(i))] = record.counts.verdicts[i];
  Json& loops = json["closed"] = Json::array();
  for (const LoopEvent& event : record.loops)
    loops.push_back({{"timestamp", event.timestamp},
                     {"candidate_timestamp", event.candidate_timestamp},
                     {"inliers", event.loop.inliers},
                     {"points_fused", event.loop.points_fused},
                     {"way_m", event.loop.way},
                     {"correction_m", event.loop.correction.metres},
                     {"correction_deg", event.loop.correction.degrees},
                     {"seconds", event.loop.seconds}});
  Json& adjustments = json["full_adjustments"] = Json::array();
  for (const FullAdjustmentSummary& summary : record.adjustments)
    adjustments.push_back({{"applied", summary.applied},
                           {"stopped", summary.stop_requested},
                           {"stop_s", summary.stop_seconds},
                           {"keyframes", summary.keyframes},
                           {"points", summary.points},
                           {"observations", summary.observations},
                           {"iterations", summary.bundle.iterations},
                           {"seconds", summary.bundle.seconds},
                           {"seconds_per_iteration", summary.seconds_per_iteration}});
  return json;
}

Json run_json(const RunRecord& record) {
  const RunSummary& s = record.summary;
  Json json = {{"holdfast", HOLDFAST_VERSION},
               {"commit", HOLDFAST_COMMIT},
               {"configuration", record.configuration->file},
               {"seed", record.configuration->run.seed},
               {"mode", record.configuration->run.mode},
               {"machine",
                {{"system", system_name()},
                 {"processor", processor()},
                 {"cores", std::thread::hardware_concurrency()},
                 {"simd", to_string(simd_level())}}},
               {"sequence", record.source.name},
               {"interrupted", record.was_interrupted}};
  json["failure"] = record.failure.empty() ? Json(nullptr) : Json(record.failure);
  json["frames"] = {{"expected", record.frames_expected},
                    {"fed", s.frames()},
                    {"skipped", record.skipped.size()},
                    {"waiting", s.count(TrackingStatus::waiting)},
                    {"tracked", s.tracked()},
                    {"lost", s.lost()},
                    {"recovered", s.recovered()},
                    {"relocalised", s.relocalised()},
                    {"poses", record.trajectory.size()},
                    {"coverage", record.coverage()}};
  Json& troubles = json["troubles"] = Json::object();
  for (const auto& [trouble, count] : s.troubles()) troubles[to_string(trouble)] = count;
  Json& skipped = json["skipped_frames"] = Json::array();
  for (const SkippedFrame& frame : record.skipped)
    skipped.push_back({{"index", frame.index}, {"timestamp", frame.timestamp}, {"reason", frame.reason}});
  json["map"] = {{"keyframes", record.map_keyframes},
                 {"points", record.map_points},
                 {"keyframes_made", record.mapping.keyframes_made},
                 {"keyframes_removed", record.mapping.keyframes_removed},
                 {"points_from_depth", record.mapping.points_from_depth},
                 {"points_triangulated", record.mapping.points_triangulated},
                 {"points_removed", record.mapping.points_removed},
                 {"points_fused", record.mapping.points_fused},
                 {"observations_removed", record.mapping.observations_removed}};
  json["loops"] = loops_json(record.loops);
  json["masks"] = {{"count", record.mask_ages.size()}};
  if (!record.mask_ages.empty()) {
    json["masks"]["median_age_s"] = median(record.mask_ages);
    json["masks"]["p95_age_s"] = percentile(record.mask_ages, 95.0);
  }
  json["mean_inliers"] = s.mean_inliers();
  json["evaluation"] = record.evaluation ? Json::parse(to_json(*record.evaluation)) : Json(nullptr);
  json["tracking"] = stage_json(s.tracking());
  Json& stages = json["stages"] = Json::array();
  for (const StageRow& row : s.stages()) stages.push_back(stage_json(row));
  json["threads"] = record.threads ? threads_json(*record.threads) : Json(nullptr);
  json["start_to_first_pose_s"] = record.start_seconds;
  json["total_s"] = record.total_seconds;
  json["peak_memory_bytes"] = record.peak_memory;
  return json;
}

ReportTable stage_report(const RunSummary& summary) {
  ReportTable table{
      "Time per frame in each stage", {"stage", "frames", "median ms", "p95 ms", "max ms", "share"}, {}, {}};
  for (const StageRow& row : summary.stages()) {
    table.rows.push_back({row.stage, std::to_string(row.frames), number(row.median * 1e3, 3), number(row.p95 * 1e3, 3),
                          number(row.maximum * 1e3, 3), number(row.share * 100.0, 1) + " %"});
    table.bars.push_back(row.share);
  }
  return table;
}

ReportTable error_report(const Evaluation& evaluation) {
  ReportTable table{"Errors", {"", "RMSE", "S.D.", "max", "min", "mean", "median", "pairs"}, {}, {}};
  const auto add = [&](const std::string& name, const Statistics& s, std::size_t pairs, int decimals) {
    if (pairs == 0) return;
    table.rows.push_back({name, number(s.rmse, decimals), number(s.standard_deviation, decimals),
                          number(s.maximum, decimals), number(s.minimum, decimals), number(s.mean, decimals),
                          number(s.median, decimals), std::to_string(pairs)});
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
                          number(queue.mean_wait() * 1e3, 2), number(queue.wait_longest * 1e3, 2), busy});
  };
  add("tracking", threads.frames, "");
  for (const WorkerCounts& worker : threads.workers) add(worker.name, worker.queue, number(worker.busy_seconds, 2));
  return table;
}

ReportTable loop_report(const LoopRecord& record) {
  ReportTable table{"Loops",
                    {"at s", "saw again s", "points found", "fused", "way m", "moved by m", "turned by deg", "took ms"},
                    {},
                    {}};
  for (const LoopEvent& event : record.loops)
    table.rows.push_back({number(event.timestamp, 2), number(event.candidate_timestamp, 2),
                          std::to_string(event.loop.inliers), std::to_string(event.loop.points_fused),
                          number(event.loop.way, 2), number(event.loop.correction.metres, 4),
                          number(event.loop.correction.degrees, 2), number(event.loop.seconds * 1e3, 0)});
  return table;
}

ReportTable adjustment_report(const LoopRecord& record) {
  ReportTable table{
      "Full adjustments", {"keyframes", "points", "iterations", "seconds", "ms an iteration", "outcome"}, {}, {}};
  for (const FullAdjustmentSummary& summary : record.adjustments)
    table.rows.push_back({std::to_string(summary.keyframes), std::to_string(summary.points),
                          std::to_string(summary.bundle.iterations), number(summary.bundle.seconds, 2),
                          number(summary.seconds_per_iteration * 1e3, 0),
                          summary.applied          ? "applied"
                          : summary.stop_requested ? "stopped"
                                                   : "no solution"});
  return table;
}

std::string report_html(const RunRecord& record) {
  Report report;
  report.title = record.source.name.empty() ? "Holdfast run" : "Holdfast: " + record.source.name;
  report.subtitle = record.configuration->file + ", seed " + std::to_string(record.configuration->run.seed) + ", " +
                    record.configuration->run.mode + ", version " HOLDFAST_VERSION;
  if (record.evaluation)
    report.highlights.push_back({"ATE RMSE", number(record.evaluation->absolute_error.rmse * 1e3, 2) + " mm"});
  report.highlights.push_back({"coverage", percent(record.coverage())});
  report.highlights.push_back({"tracking", number(record.summary.tracking().median * 1e3, 2) + " ms"});
  ReportSection summary{.heading = "Summary",
                        .text = {},
                        .values = summary_rows(record),
                        .tables = {},
                        .figures = {},
                        .preformatted = {}};
  if (!record.failure.empty()) summary.text = "The run ended before its time: " + record.failure;
  if (record.was_interrupted) summary.text = "The run was interrupted; this is what was done until then.";
  report.sections.push_back(std::move(summary));
  if (record.evaluation) {
    ReportSection error{.heading = "Trajectory",
                        .text = {},
                        .values = {},
                        .tables = {error_report(*record.evaluation)},
                        .figures = {},
                        .preformatted = {}};
    error.text =
        "Aligned with the truth by a rigid motion (se3) over all pairs; stamps paired one to one within 0.02 s.";
    error.figures.push_back({top_view_svg(*record.evaluation), "The path against the truth"});
    error.figures.push_back({error_over_time_svg(*record.evaluation), "Absolute error over time"});
    report.sections.push_back(std::move(error));
  }
  report.sections.push_back({.heading = "Stages",
                             .text = {},
                             .values = {},
                             .tables = {stage_report(record.summary)},
                             .figures = {},
                             .preformatted = {}});
  if (!record.loops.loops.empty())
    report.sections.push_back({.heading = "Loops",
                               .text = {},
                               .values = {},
                               .tables = {loop_report(record.loops), adjustment_report(record.loops)},
                               .figures = {},
                               .preformatted = {}});
  if (record.threads)
    report.sections.push_back({.heading = "Threads",
                               .text = "Late frames: " + std::to_string(record.threads->late) + ", at most by " +
                                       number(record.threads->latest * 1e3, 1) + " ms; keyframes put off: " +
                                       std::to_string(record.threads->keyframes_deferred) + ".",
                               .values = {},
                               .tables = {thread_report(*record.threads)},
                               .figures = {},
                               .preformatted = {}});
  if (!record.skipped.empty()) {
    ReportTable table{"Frames left out", {"stamp", "reason"}, {}, {}};
    for (const SkippedFrame& frame : record.skipped) table.rows.push_back({number(frame.timestamp, 6), frame.reason});
    report.sections.push_back(
        {.heading = "Skipped frames", .text = {}, .values = {}, .tables = {table}, .figures = {}, .preformatted = {}});
  }
  report.sections.push_back({.heading = "Configuration",
                             .text = {},
                             .values = {},
                             .tables = {},
                             .figures = {},
                             .preformatted = to_yaml(*record.configuration)});
  return to_html(report);
}

}  // namespace

double ThreadRecord::late_share() const {
  if (delays.empty()) return 0.0;
  const auto above = std::count_if(delays.begin(), delays.end(), [](double seconds) { return seconds > 0.033; });
  return static_cast<double>(above) / static_cast<double>(delays.size());
}

double RunRecord::coverage() const {
  return frames_expected == 0 ? 0.0 : static_cast<double>(trajectory.size()) / static_cast<double>(frames_expected);
}

void write_run_results(const std::filesystem::path& folder, const RunRecord& record) {
  write_trajectory(folder / "trajectory.txt", record.trajectory);
  write_trajectory(folder / "keyframes.txt", record.keyframes);
  if (record.evaluation) {
    write_file_atomically(folder / "evaluation.json", to_json(*record.evaluation));
    write_file_atomically(folder / "tracks.json", to_tracks_json(*record.evaluation));
    write_file_atomically(folder / "trajectory.svg", top_view_svg(*record.evaluation));
    write_file_atomically(folder / "error.svg", error_over_time_svg(*record.evaluation));
  }
  write_file_atomically(folder / "run.json", run_json(record).dump(2) + "\n");
  write_file_atomically(folder / "report.html", report_html(record));
}

std::string run_summary_text(const RunRecord& record) {
  std::string text = stage_table(record.summary) + "\n";
  for (const auto& [name, value] : summary_rows(record)) {
    std::string label = name;
    label.resize(std::max<std::size_t>(label.size() + 1, 21), ' ');
    text += label + value + "\n";
  }
  return text;
}

}  // namespace holdfast
