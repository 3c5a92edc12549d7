// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/run/run.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <utility>

#include "focal_check.hpp"
#include "frame_loop.hpp"
#include "holdfast/core/counted.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/metric_map.hpp"
#include "holdfast/dense_map/static_scene.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/surface/class_colours.hpp"
#include "holdfast/surface/decimation.hpp"
#include "holdfast/surface/surface_map.hpp"
#include "run_warnings.hpp"

namespace holdfast {

namespace {

std::size_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

/// A run that ended early has frames whose time stamps were never read. They count as missing, in a gap at the end.
void count_unread_frames(const RunRecord& record, Coverage& coverage) {
  if (record.frame_stamps.size() >= record.frames_expected) return;
  const std::size_t missing = record.frames_expected - record.frame_stamps.size();
  const double last = record.frame_stamps.back();
  coverage.frames += missing;
  const bool gap_is_open = !coverage.gaps.empty() && coverage.gaps.back().end == last &&
                           (record.trajectory.empty() || record.trajectory.back().timestamp < last);
  if (!gap_is_open) coverage.gaps.push_back({last, last, 0});
  coverage.gaps.back().frames += missing;
}

void evaluate_run(const FrameSource& source, RunRecord& record) {
  const Trajectory truth = source.truth();
  if (truth.empty()) {
    record.no_evaluation = "the source has no truth";
    return;
  }
  for (const SkippedFrame& skipped : record.skipped) record.frame_stamps.push_back(skipped.timestamp);
  std::sort(record.frame_stamps.begin(), record.frame_stamps.end());
  EvaluationOptions options;
  options.alignment = record.is_metric ? AlignmentKind::se3 : AlignmentKind::sim3;
  options.truth_name = "truth";
  options.truth_frame = record.source.truth_frame;
  options.estimate_name = "trajectory.txt";
  try {
    record.evaluation = evaluate(truth, record.trajectory, options, record.frame_stamps);
  } catch (const Error& error) {
    record.no_evaluation = error.what();
    return;
  }
  if (record.evaluation->coverage) count_unread_frames(record, *record.evaluation->coverage);
}

void record_pipeline(const Pipeline& pipeline, RunRecord& record) {
  record.trajectory = pipeline.trajectory();
  record.keyframes = pipeline.keyframe_trajectory();
  record.map_keyframes = pipeline.map().keyframes().size();
  record.map_points = pipeline.map().points().size();
  record.is_metric = is_metric(pipeline.map());
  record.mapping = pipeline.mapping_counts();
  record.loops = pipeline.loop_record();
  record.losses = pipeline.loss_record();
  record.masks = pipeline.mask_counts();
  record.mask_ages = pipeline.mask_latencies();
  record.readout = pipeline.readout();
  record.focal_ratio = estimate_focal_ratio(pipeline.map());
  record.pair = pipeline.pair_calibration();
}

void record_navigation(const SurfaceMap& surface, RunRecord& record) {
  record.navigation = make_navigation_maps(surface, *record.surface);
  constexpr double least_floor = 1.0;  // [m^2]
  if (const double area = record.navigation->floor ? record.navigation->floor->area : 0.0; area < least_floor)
    add_warning(record.warnings,
                {{},
                 (record.navigation->floor
                      ? "the floor of map.pgm is a plane of " + fixed_text(area, 2) + " m^2: is it a table?"
                      : std::string("no floor was found, and map.pgm is not written.")) +
                     " Let the camera see more of the floor"});
}

/// `classes`: of the map; empty without a segmenter.
void record_surface(const SurfaceMap& surface, const std::vector<std::string>& classes, RunRecord& record) {
  record.surface = surface.field().mesh();
  if (surface.field().settings().classes) record.surface->classes = classes;
  record.surface_bytes = surface.memory_bytes();
  if (surface.field().settings().keep_depth) {
    record.surface_views = SurfaceViews::of(surface);
    record.surface_views->classes = record.surface->classes;
  }
  if (record.surface->empty())
    add_warning(record.warnings,
                {{},
                 "the surface is empty, and no mesh is written: " + counted(surface.fused_view_count(), "view") +
                     " with depth up to " + fixed_text(surface.field().settings().maximum_depth, 1) +
                     " m show no surface that at least " + std::to_string(surface.field().settings().minimum_views) +
                     " of them observed; check the depth of the source, and `surface.maximum_depth`"});
  const SurfaceSettings& settings = surface.field().settings();
  if (settings.navigation && !record.surface->empty()) record_navigation(surface, record);
  if (settings.triangles > 0) decimate(*record.surface, static_cast<std::size_t>(settings.triangles));
  if (settings.class_colours && !classes.empty()) colour_by_class(*record.surface);
}

}  // namespace

RunRecord run(BuiltPipeline& built, const Configuration& configuration, const RunOptions& options) {
  RunRecord record;
  record.configuration = configuration;
  record.source = built.source->describe();
  record.camera = built.pipeline.camera();
  record.sensor = built.pipeline.sensor();
  record.is_metric = scale_is_known(record.sensor);
  record.localised_only = options.pipeline.localise_only;
  record.warnings = configuration.warnings;
  add_warnings(record.warnings, built.warnings());
  if (options.on_start) options.on_start(record);
  feed_frames(built, options, record);

  record.frames_expected = record.source.frame_count ? static_cast<std::size_t>(*record.source.frame_count)
                                                     : record.frame_stamps.size() + record.skipped.size();
  record_pipeline(built.pipeline, record);
  evaluate_run(*built.source, record);
  add_warnings(record.warnings, built.warnings());
  if (record.evaluation) add_warnings(record.warnings, record.evaluation->warnings);
  add_warnings(record.warnings, find_warnings(record));
  record.total_seconds = options.since_start.seconds();
  record.peak_memory = peak_memory();
  return record;
}

RunRecord run(const Configuration& configuration, const Registry& registry, const RunOptions& options) {
  BuiltPipeline built = build_pipeline(configuration, registry, options.pipeline);
  if (options.wrap_source) built.source = options.wrap_source(std::move(built.source));
  RunRecord record = run(built, configuration, options);
  if (const StaticScene* scene = built.pipeline.static_scene()) record.dense_map = scene->cloud(built.pipeline.map());
  if (const SurfaceMap* surface = built.pipeline.surface())
    record_surface(*surface, built.pipeline.map().classes(), record);
  record.map = built.pipeline.take_map();
  return record;
}

}  // namespace holdfast
