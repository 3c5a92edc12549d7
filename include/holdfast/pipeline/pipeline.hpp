// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/config/run_settings.hpp"
#include "holdfast/core/camera.hpp"
#include "holdfast/core/frame_health.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/imu.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/map_snapshot.hpp"
#include "holdfast/core/pair_errors.hpp"
#include "holdfast/core/sensor.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/core/worker_counts.hpp"
#include "holdfast/dense_map/dense_map_settings.hpp"
#include "holdfast/interfaces/all.hpp"
#include "holdfast/loop_closing/closed_loop.hpp"
#include "holdfast/loop_closing/full_adjustment_summary.hpp"
#include "holdfast/loop_closing/loop_closing_settings.hpp"
#include "holdfast/mapping/mapping_counts.hpp"
#include "holdfast/mapping/mapping_settings.hpp"
#include "holdfast/moving_world/evidence_settings.hpp"
#include "holdfast/moving_world/mask_counts.hpp"
#include "holdfast/moving_world/segmentation_settings.hpp"
#include "holdfast/surface/surface_settings.hpp"
#include "holdfast/tracking/loss_record.hpp"
#include "holdfast/tracking/stereo_settings.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

class FreeSpace;

class StaticScene;
class SurfaceMap;

/// Modules and settings of a pipeline, checked and filled by PipelineBuilder.
struct PipelineParts {
  Camera camera;
  std::unique_ptr<FeatureExtractor> features;
  std::string features_name;                ///< name of the module; empty for an unnamed instance
  std::unique_ptr<FeatureMatcher> matcher;  ///< nullptr = NearestMatcher
  Sensor sensor = Sensor::rgbd;
  std::unique_ptr<FeatureExtractor> right_features;  ///< extractor for right images; may be nullptr, see StereoParts
  std::unique_ptr<DenseStereo> dense_stereo;         ///< dense matcher of a stereo pair; nullptr = by stereo.dense
  std::unique_ptr<Segmenter> segmenter;
  std::vector<std::pair<std::string, std::unique_ptr<DynamicFilter>>> filters;  ///< by name, in order
  std::unique_ptr<Optimizer> optimizer;
  std::unique_ptr<LoopDetector> loop_detector;
  std::vector<std::unique_ptr<Observer>> observers;
  std::optional<ImuCalibration> imu;  ///< frames have inertial measurements of this IMU
  bool checks_imu = true;             ///< the plausibility check of the measurements adds warnings
  TrackingSettings tracking;
  StereoSettings stereo;
  EvidenceSettings evidence;
  SegmentationSettings segmentation;
  MappingSettings mapping;
  LoopClosingSettings loop_closing;
  DenseMapSettings dense_map;
  SurfaceSettings surface;
  RunSettings run;
  /// Frames have a depth image, or get one from their pair.
  bool has_dense_depth() const {
    return sensor == Sensor::rgbd || (sensor == Sensor::stereo && stereo.dense != DenseStereoMethod::off);
  }
  Map map;                     ///< map to continue; empty = begin a new map
  bool localise_only = false;  ///< localisation in the map without changing it
  Warnings warnings;           ///< about questionable combinations of modules and settings
};

/// A closed loop and the time stamps of its two keyframes [s].
struct LoopEvent {
  double timestamp = 0.0;
  double candidate_timestamp = 0.0;
  ClosedLoop loop;
};

/// Counters and events of loop closing since the start of the run.
struct LoopRecord {
  LoopCounts counts;
  std::vector<LoopEvent> loops;
  std::vector<FullAdjustmentSummary> adjustments;
};

/// A visual SLAM system: estimates poses and a map from frames. Pipelines are independent of each other; a process may
/// have any number of them.
///
/// Sequential mode: feed() processes a frame completely in the calling thread, including mapping and loop closing, and
/// results are bit-identical on every run. Threaded mode: feed() tracks the frame and inserts keyframes; local mapping,
/// loop closing, full bundle adjustment and segmentation run in separate threads. Tracking waits for them only when the
/// queue of keyframes is full and frames are not paced. interrupt(), health(), map_snapshot(), save_map(), free_space()
/// and with_surface() may be called by any thread, all other functions by one thread at a time.
class Pipeline {
 public:
  /// Throws CheckError if a required module is missing.
  explicit Pipeline(PipelineParts parts);
  /// Ends the threads: requests the jobs in progress to end early, waits for them, and discards queued jobs.
  ~Pipeline();
  Pipeline(Pipeline&&) noexcept;
  Pipeline& operator=(Pipeline&&) noexcept;

  /// Waits until modules have finished loading in the background (such as the weights of a network), so that errors are
  /// thrown here and not by a later feed(). Optional, before the first feed().
  void finish_loading();
  /// Segmenter::description() of the segmenter; empty without one.
  std::string segmenter_description() const;
  /// Processes one frame. Time stamps must increase strictly (InputError otherwise). A tracking failure is a typed
  /// result. Rethrows exceptions of the pipeline's threads.
  FrameResult feed(const SensorFrame& frame);
  /// Ends the run: waits until the threads have processed their queues, runs full bundle adjustment again if the map
  /// has grown since the last loop, or MappingSettings::final_rounds says so (unless interrupted), scales the map of
  /// one camera to metres if inertial measurements gave the scale, and notifies the observers. feed() must not be
  /// called afterwards; a second call does nothing, also after an exception. Rethrows exceptions of the pipeline's
  /// threads.
  void finish();
  /// Ends running bundle adjustments after their current iteration, and the waits of observers (Observer::interrupt()),
  /// both for the rest of the run: a viewer no longer pauses, and finish() neither adjusts nor smooths again, and
  /// locates no further frames. Any thread, also during feed() and finish().
  void interrupt();

  /// Health of the last frame, as a robot acts on it, and whether frames still arrive: the state is stalled if there
  /// was no frame for `patience` of their usual periods. Waits for nothing. Any thread, in both modes.
  PipelineHealth health(double patience = 10.0) const;

  /// Poses of all tracked frames in temporal order, with all corrections so far. If the map consists of several
  /// submaps, the poses of the submap with most frames (TrackingSettings::restart_time). World frame: the first camera
  /// frame, or that of the continued map.
  Trajectory trajectory() const;
  /// Poses of the frames with exactly these time stamps [s], with all corrections so far and consistent with each
  /// other: no correction lies between them. Frames without a pose are left out. Takes microseconds for a few frames.
  Trajectory poses_at(const std::vector<double>& timestamps) const;
  /// Poses of the keyframes in the map, by time.
  Trajectory keyframe_trajectory() const;
  /// Copy of the current keyframes, points and loops, during which the run continues. Any thread, in both modes.
  /// Tracking waits for the copy, about 2 ms for 50000 points.
  MapSnapshot map_snapshot() const;
  /// Writes the map as it is now to a file (map_io/map_file.hpp) while the run continues: the submap of trajectory(),
  /// and points with the classes of the map that is continued, because new ones are classified by finish(). Waits until
  /// the keyframe in progress is refined; tracking waits for the writing. Any thread, in both modes, but not during
  /// finish(). Throws InputError if the file cannot be written, and Error if there is no map yet.
  void save_map(const std::filesystem::path& file) const;
  /// The map. In threaded mode only after finish().
  const Map& map() const;
  /// Moves the map out of the pipeline. Only the destructor may be called afterwards.
  Map take_map();
  /// Kept keyframe images for the dense map; nullptr unless DenseMapSettings::enabled. Not while feed() runs.
  const StaticScene* static_scene() const;
  /// The fused surface of the static scene; nullptr unless SurfaceSettings::enabled. Complete, with final poses, after
  /// finish().
  const SurfaceMap* surface() const;
  /// Free space of the surface as fused so far, in cells of SurfaceSettings::cell; nullptr without a surface. Kept
  /// until more is fused: the first call after a keyframe meshes the surface, which takes 50 ms for a room and longer
  /// for a hall, and fusion waits for it. From any thread, in both modes.
  std::shared_ptr<const FreeSpace> free_space() const;
  /// Calls `look` with the surface as fused so far; the fusion waits meanwhile, tracking does not. Returns false,
  /// without a call, if there is no surface. Any thread, in both modes; with SurfaceSettings::poses, `look` must not
  /// call the pipeline.
  bool with_surface(const std::function<void(const SurfaceMap&)>& look) const;
  /// FreeSpace::is_free() and FreeSpace::distance() [m] of free_space(), for a point in world coordinates. Throw Error
  /// without a surface.
  bool is_free(const Eigen::Vector3d& point) const;
  double distance(const Eigen::Vector3d& point) const;
  const MappingCounts& mapping_counts() const;
  LoopRecord loop_record() const;
  const Camera& camera() const;
  Sensor sensor() const;
  /// Current rolling-shutter readout time of the correction [s], estimated if configured; 0 = no correction.
  double readout() const;
  /// Current estimate of the calibration errors of a stereo pair. Empty without a pair, and if
  /// StereoSettings::self_calibration is off.
  std::optional<PairEstimate> pair_calibration() const;

  /// Warnings about the configuration, and those of the modules about their input (core/warning.hpp). Before the first
  /// frame or after finish().
  Warnings warnings() const;

  /// Statistics of the frames around tracking losses; complete after finish().
  LossRecord loss_record() const;

  /// Stage times of the background threads since the last call. In sequential mode FrameResult contains them.
  std::vector<StageTimes> take_background_times();
  /// Statistics of the segmented frames; complete after finish().
  const MaskCounts& mask_counts() const;
  /// Latency of each mask: from the time stamp of its frame to that of the first frame to which it was applied, or of
  /// the last frame of the run [s].
  const std::vector<double>& mask_latencies() const;
  /// Number of keyframes that were deferred because the mapping thread was busy.
  std::uint64_t keyframes_deferred() const;
  /// One entry per thread of the pipeline; empty in sequential mode.
  std::vector<WorkerCounts> worker_counts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace holdfast
