// SPDX-License-Identifier: BSD-3-Clause
#include <sys/utsname.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "holdfast/core/simd.hpp"
#include "holdfast/core/version.hpp"
#include "holdfast/evaluation/statistics.hpp"
#include "holdfast/run/results.hpp"
#include "summary.hpp"

namespace holdfast {

namespace {

using Json = nlohmann::ordered_json;

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
               {"latest_s", threads.largest_delay},
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

Json pair_json(const PairEstimate& estimate) {
  const auto json_of = [](const Eigen::Vector3d& v) { return Json{v.x(), v.y(), v.z()}; };
  return {{"rotation_rad", json_of(estimate.errors.rotation)},
          {"rotation_sigma_rad", json_of(estimate.rotation_sigma)},
          {"focal_ratio", estimate.errors.focal_ratio},
          {"focal_ratio_sigma", estimate.focal_ratio_sigma},
          {"column_offset_px", estimate.errors.column_offset},
          {"radial", estimate.errors.radial},
          {"radial_sigma", estimate.radial_sigma},
          {"decentring", estimate.errors.decentring},
          {"decentring_sigma", estimate.decentring_sigma},
          {"shift_px", estimate.shift},
          {"shift_sigma_px", estimate.shift_sigma}};
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
                     {"joins_submaps", event.loop.joins_submaps},
                     {"path_length_m", event.loop.path_length},
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

Json machine_json() {
  return {{"system", system_name()},
          {"processor", processor()},
          {"cores", std::thread::hardware_concurrency()},
          {"simd", to_string(simd_level())}};
}

Json frames_json(const RunRecord& record) {
  const RunSummary& s = record.summary;
  return {{"expected", record.frames_expected},
          {"fed", s.frames()},
          {"skipped", record.skipped.size()},
          {"waiting", s.count(TrackingStatus::waiting)},
          {"tracked", s.tracked()},
          {"lost", s.lost()},
          {"recovered", s.recovered()},
          {"relocalised", s.relocalised()},
          {"by_flow", s.by_flow()},
          {"by_odometry", s.count(TrackingFallback::odometry)},
          {"by_masked_features", s.count(TrackingFallback::masked_features)},
          {"by_dense_depth", s.count(TrackingFallback::dense_depth)},
          {"by_inertia", s.count(TrackingStatus::inertial)},
          {"tracked_backwards", record.losses.tracked_backwards},
          {"located_late", record.losses.located_late},
          {"placed_by_inertia", record.losses.placed_by_inertia},
          {"withdrawn", record.losses.withdrawn},
          {"left_out", record.losses.left_out},
          {"poses", record.trajectory.size()},
          {"coverage", record.coverage()}};
}

Json health_json(const RunSummary& summary) {
  Json json;
  for (const HealthState state : {HealthState::good, HealthState::degraded, HealthState::inertial,
                                  HealthState::relocalised, HealthState::lost, HealthState::waiting})
    json[to_string(state)] = summary.count(state);
  Json& reasons = json["reasons"] = Json::object();
  for (const auto& [reason, frames] : summary.reasons()) reasons[to_string(reason)] = frames;
  json["largest_jump"] = summary.largest_jump();
  return json;
}

Json map_json(const RunRecord& record) {
  return {{"keyframes", record.map_keyframes},
          {"points", record.map_points},
          {"submaps_begun", record.losses.submaps},
          {"keyframes_made", record.mapping.keyframes_made},
          {"keyframes_removed", record.mapping.keyframes_removed},
          {"points_from_depth", record.mapping.points_from_depth},
          {"points_triangulated", record.mapping.points_triangulated},
          {"points_removed", record.mapping.points_removed},
          {"points_fused", record.mapping.points_fused},
          {"observations_removed", record.mapping.observations_removed}};
}

Json perturbation_json(const Configuration& configuration) {
  Json json = Json::object();
  for (const auto& [name, strength] : perturbation_strengths(configuration)) json[name] = strength;
  return json;
}

Json masks_json(const MaskCounts& masks, const std::vector<double>& ages) {
  Json json = {{"count", masks.found},
               {"segmented", masks.segmented},
               {"mostly_movable", masks.mostly_movable},
               {"upper_edge_movable", masks.upper_edge_movable}};
  if (ages.empty()) return json;
  json["median_age_s"] = median(ages);
  json["p95_age_s"] = percentile(ages, 95.0);
  return json;
}

}  // namespace

std::string machine_text() {
  return processor() + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores, " +
         to_string(simd_level());
}

std::string run_json(const RunRecord& record) {
  const RunSummary& s = record.summary;
  Json json = {{"holdfast", HOLDFAST_VERSION},
               {"commit", build_commit()},
               {"configuration", record.configuration.file},
               {"seed", record.configuration.run.seed},
               {"mode", choice_name(record.configuration.run.mode)},
               {"machine", machine_json()},
               {"sequence", record.source.name},
               {"sensor", sensor_name(record.sensor)},
               {"is_metric", record.is_metric},
               {"interrupted", record.was_interrupted}};
  json["failure"] = record.failure.empty() ? Json(nullptr) : Json(record.failure);
  Json& warnings = json["warnings"] = Json::array();
  for (const Diagnostic& warning : record.warnings) warnings.push_back(warning.to_string());
  if (const std::string warning = coverage_warning(record); !warning.empty()) warnings.push_back(warning);
  json["perturbation"] = perturbation_json(record.configuration);
  json["frames"] = frames_json(record);
  json["health"] = health_json(s);
  Json& failures = json["tracking_failures"] = Json::object();
  for (const auto& [failure, count] : s.failures()) failures[to_string(failure)] = count;
  Json& skipped = json["skipped_frames"] = Json::array();
  for (const SkippedFrame& frame : record.skipped)
    skipped.push_back({{"index", frame.index}, {"timestamp", frame.timestamp}, {"reason", frame.reason}});
  json["repeated_images"] = {{"frames", record.repeated_images.frames},
                             {"longest_s", record.repeated_images.longest},
                             {"longest_from", record.repeated_images.begin}};
  if (const std::optional<FocalRatio>& focal = record.focal_ratio)
    json["focal_ratio"] = {{"value", focal->ratio}, {"deviation", focal->deviation}};
  json["map"] = map_json(record);
  if (record.surface)
    json["surface"] = {{"area_m2", record.surface->area()},
                       {"triangles", record.surface->triangles.size()},
                       {"memory_bytes", record.surface_bytes}};
  json["loops"] = loops_json(record.loops);
  json["masks"] = masks_json(record.masks, record.mask_ages);
  json["mean_inliers"] = s.mean_inliers();
  json["readout_s"] = record.readout;
  json["pair_calibration"] = record.pair ? pair_json(*record.pair) : Json(nullptr);
  json["evaluation"] = record.evaluation ? Json::parse(to_json(*record.evaluation)) : Json(nullptr);
  json["tracking"] = stage_json(s.tracking());
  Json& stages = json["stages"] = Json::array();
  for (const StageRow& row : s.stages()) stages.push_back(stage_json(row));
  json["threads"] = record.threads ? threads_json(*record.threads) : Json(nullptr);
  json["start_to_first_pose_s"] = record.start_seconds > 0.0 ? Json(record.start_seconds) : Json(nullptr);
  json["total_s"] = record.total_seconds;
  json["peak_memory_bytes"] = record.peak_memory;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace holdfast
