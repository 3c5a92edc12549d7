// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/config/run_settings.hpp"
#include "holdfast/core/camera.hpp"
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

/// The parts of a pipeline. PipelineBuilder checks and fills them.
struct PipelineParts {
  Camera camera;
  std::unique_ptr<FeatureExtractor> features;
  std::string features_name;                ///< of the module; empty for an object without a name
  std::unique_ptr<FeatureMatcher> matcher;  ///< nullptr = NearestMatcher
  Sensor sensor = Sensor::rgbd;
  std::unique_ptr<FeatureExtractor> right_features;  ///< of a stereo pair; may be nullptr, see StereoParts
  std::unique_ptr<Segmenter> segmenter;
  std::vector<std::pair<std::string, std::unique_ptr<DynamicFilter>>> filters;  ///< by name, in order
  std::unique_ptr<Optimizer> optimizer;
  std::unique_ptr<LoopDetector> loop_detector;
  std::vector<std::unique_ptr<Observer>> observers;
  std::optional<ImuCalibration> imu;  ///< frames have inertial measurements of this IMU
  bool checks_imu = true;             ///< suspicions about the measurements are warnings of the pipeline
  TrackingSettings tracking;
  StereoSettings stereo;
  EvidenceSettings evidence;
  SegmentationSettings segmentation;
  MappingSettings mapping;
  LoopClosingSettings loop_closing;
  DenseMapSettings dense_map;
  SurfaceSettings surface;
  RunSettings run;
  Map map;                     ///< map to continue; empty = begin a new map
  bool localise_only = false;  ///< find poses in the map and leave it unchanged
  Warnings warnings;           ///< about parts that fit together badly
};

/// A loop that was closed, with the stamps of both its ends [s].
struct LoopEvent {
  double timestamp = 0.0;
  double candidate_timestamp = 0.0;
  ClosedLoop loop;
};

/// What loop closing did so far.
struct LoopRecord {
  LoopCounts counts;
  std::vector<LoopEvent> loops;
  std::vector<FullAdjustmentSummary> adjustments;
};

/// Visual SLAM from frames to poses and a map. Pipelines share nothing: any number may live in one process.
///
/// Sequential mode: feed() does all the work of a frame, mapping and loop closing included, in the calling thread, and
/// gives the same bits on every run. Threaded mode: feed() tracks the frame and inserts keyframes; local mapping, loop
/// closing, full bundle adjustment and segmentation have threads of their own, and tracking waits for none of them
/// except, when it is not paced, for room in the queue of keyframes. One thread at a time calls feed(), finish() and
/// the rest, all but interrupt() and map_snapshot().
class Pipeline {
 public:
  /// Throws CheckError when a required part is missing.
  explicit Pipeline(PipelineParts parts);
  /// Ends the threads: waits for the jobs in progress, which are asked to end early; what waits is abandoned.
  ~Pipeline();
  Pipeline(Pipeline&&) noexcept;
  Pipeline& operator=(Pipeline&&) noexcept;

  /// Waits for what modules load in the background, such as the weights of a network, so that its errors are thrown
  /// here and not by a later feed(). Optional, before the first feed().
  void finish_loading();
  /// Segmenter::description() of the segmenter, for people; empty without one.
  std::string segmenter_description() const;
  /// Processes one frame; time stamps must rise strictly (InputError otherwise). Trouble with the frame is a typed
  /// result. Throws what a thread of the pipeline threw.
  FrameResult feed(const SensorFrame& frame);
  /// Ends the run: waits until the threads have done what waits for them, adjusts the whole map once more when it grew
  /// after a loop and nobody interrupted, and tells the observers. feed() must not be
  /// called any more. Throws what a thread of the pipeline threw.
  void finish();
  /// Makes long adjustments in progress end after their current iteration. From any thread.
  void interrupt();

  /// Poses of all tracked frames, in order, as corrected by all that came later; where the map is in submaps, those of
  /// the submap with most frames (TrackingSettings::restart_time). World frame: the first camera's, or
  /// that of the map that was continued.
  Trajectory trajectory() const;
  /// Poses of the keyframes in the map, by time.
  Trajectory keyframe_trajectory() const;
  /// Keyframes, points and loops as they are now, copied between two steps of whoever works on the map: frames and
  /// background work go on. From any thread, in both modes. Tracking waits for the copy, about 2 ms for 50000 points.
  MapSnapshot map_snapshot() const;
  /// In threaded mode only after finish().
  const Map& map() const;
  /// Hands the map over and leaves an empty one; nothing else may be called but the destructor.
  Map take_map();
  /// What keyframes saw of the static scene; nullptr unless DenseMapSettings::enabled. Not while feed() runs.
  const StaticScene* static_scene() const;
  /// The fused surface of the static scene; nullptr unless SurfaceSettings::enabled. After finish() it has every kept
  /// view at its final pose; not before.
  const SurfaceMap* surface() const;
  /// Free space of the surface as fused so far, in cells of SurfaceSettings::cell; nullptr without a surface. Kept
  /// until more is fused: the first call after a keyframe meshes the surface, which takes 50 ms for a room and longer
  /// for a hall, and fusion waits for it. From any thread, in both modes.
  std::shared_ptr<const FreeSpace> free_space() const;
  /// FreeSpace::is_free() and FreeSpace::distance() [m] of free_space(), for a point in world coordinates. Throw Error
  /// without a surface.
  bool is_free(const Eigen::Vector3d& point) const;
  double distance(const Eigen::Vector3d& point) const;
  const MappingCounts& mapping_counts() const;
  LoopRecord loop_record() const;
  const Camera& camera() const;
  Sensor sensor() const;
  /// The readout time by which features are corrected now, estimated if the settings say so [s]; 0 = not corrected.
  double readout() const;
  /// What is known of the errors of a stereo pair's calibration by now; nothing without a pair, or with
  /// StereoSettings::self_calibration off.
  std::optional<PairEstimate> pair_calibration() const;

  /// Suspicions about the parts, and of the modules about what they were given (core/warning.hpp). Before the first
  /// frame or after finish().
  Warnings warnings() const;

  /// What became of frames around losses; complete after finish().
  LossRecord loss_record() const;

  /// Stage times of background work done since the last call; in sequential mode they are in each FrameResult.
  std::vector<StageTimes> take_background_times();
  /// Of the frames whose segmentation has arrived; complete after finish().
  const MaskCounts& mask_counts() const;
  /// From the stamp of each frame with a segmentation to that of the first frame for which its mask counted, or of the
  /// last frame of the run [s].
  const std::vector<double>& mask_latencies() const;
  /// Keyframes that were due but found the mapping thread too busy.
  std::uint64_t keyframes_deferred() const;
  /// One entry per thread of the pipeline; empty in sequential mode.
  std::vector<WorkerCounts> worker_counts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace holdfast
