// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/evaluation/evaluation.hpp"
#include "holdfast/evaluation/run_summary.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/map_io/cloud_ply.hpp"
#include "holdfast/pipeline/pipeline.hpp"
#include "holdfast/surface/free_space.hpp"
#include "holdfast/surface/surface_views.hpp"
#include "holdfast/surface/triangle_mesh.hpp"

namespace holdfast {

/// Queues and delays of a run in threaded mode.
struct ThreadRecord {
  QueueCounts frames;          ///< the queue between the source and tracking
  std::uint64_t late = 0;      ///< paced: frames delivered late by the source
  double largest_delay = 0.0;  ///< paced: largest delay of such a frame [s]
  std::vector<double> delays;  ///< per frame, time from when it was due (not paced: read) until its result [s]
  std::vector<WorkerCounts> workers;
  std::uint64_t keyframes_deferred = 0;  ///< keyframes that found the queue of local mapping full

  /// Share of the delays above 33 ms, the frame interval of a camera at 30 Hz. 0 to 1.
  double late_share() const;
};

/// Frames whose colour image equals that of the previous frame, byte by byte: repeated by a driver or a copy, because
/// sensor noise never repeats.
struct RepeatedImages {
  std::size_t frames = 0;
  double longest = 0.0;  ///< longest time during which the image stayed the same [s]
  double begin = 0.0;    ///< time stamp of the frame with which it began [s]
};

/// Estimated ratio of the true focal length to the configured one, from depths of points before and after rotations.
struct FocalRatio {
  double ratio = 1.0;
  double deviation = 0.0;  ///< standard deviation, from the scatter of parts of the run
};

/// All results of a run. The record owns its content and does not refer to the pipeline.
struct RunRecord {
  Configuration configuration;
  SourceDescription source;
  Camera camera;
  Sensor sensor = Sensor::rgbd;
  double readout = 0.0;              ///< Pipeline::readout() at the end [s]
  std::optional<PairEstimate> pair;  ///< Pipeline::pair_calibration() at the end
  RunSummary summary;                ///< counts and stage times over all frames
  RepeatedImages repeated_images;
  std::optional<FocalRatio> focal_ratio;  ///< empty without depth
  std::vector<SkippedFrame> skipped;
  std::vector<double> frame_stamps;  ///< time stamps of all frames of the source, skipped ones included, sorted [s]
  std::size_t frames_expected = 0;   ///< number of frames that the source announced, else the number of frame_stamps

  Trajectory trajectory;          ///< poses of all tracked frames, T_world_camera
  Trajectory keyframes;           ///< poses of the keyframes in the map, T_world_camera
  std::size_t map_keyframes = 0;  ///< number of keyframes in the map at the end
  std::size_t map_points = 0;     ///< number of points in the map at the end
  bool is_metric = false;  ///< lengths are metres: not those of one camera, unless inertial measurements scale them
  Map map;                 ///< the map at the end; empty when the caller keeps the pipeline, see run()
  bool localised_only = false;                       ///< localisation in a given map, which was not changed
  std::optional<std::vector<CloudPoint>> dense_map;  ///< cloud of the static scene, with dense_map.enabled
  std::optional<TriangleMesh> surface;               ///< mesh of the static scene, with surface.enabled
  std::size_t surface_bytes = 0;                     ///< memory of its field and of the views that it keeps
  std::optional<SurfaceViews> surface_views;         ///< with surface.keep_depth
  std::optional<NavigationMaps> navigation;          ///< with surface.navigation; never without a mesh
  MappingCounts mapping;
  LoopRecord loops;
  LossRecord losses;
  MaskCounts masks;                     ///< statistics of the segmented frames
  std::vector<double> mask_ages;        ///< age of each segmentation mask when it was first used [s]
  std::optional<ThreadRecord> threads;  ///< in threaded mode

  std::optional<Evaluation> evaluation;  ///< where the source has a true trajectory
  std::string no_evaluation;             ///< the reason why there is no evaluation
  /// Warnings of the configuration, the modules, the evaluation and the figures of the run, in this order;
  /// coverage_warning() reports a low coverage. See core/warning.hpp.
  Warnings warnings;

  double start_seconds = 0.0;    ///< time from the start of the run to the first pose; 0 if there was none [s]
  double total_seconds = 0.0;    ///< duration of the run, evaluation included and dense map excluded [s]
  std::size_t peak_memory = 0;   ///< largest resident memory of the process so far [bytes]
  bool was_interrupted = false;  ///< ended by RunOptions::stop
  std::string failure;           ///< message of the exception that ended the run early; empty when none did

  /// Number of poses divided by the number of expected frames, skipped ones included. 0 to 1.
  double coverage() const;
};

}  // namespace holdfast
