// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/pipeline/pipeline.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>

#include "guarded_map.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/imu_plausibility.hpp"
#include "holdfast/core/imu_timeline.hpp"
#include "holdfast/core/metric_map.hpp"
#include "holdfast/core/stereo_calibration.hpp"
#include "holdfast/core/thread_annotations.hpp"
#include "holdfast/interfaces/inertial_history.hpp"
#include "holdfast/map_io/map_export.hpp"
#include "holdfast/map_io/map_file.hpp"
#include "holdfast/moving_world/moving_world.hpp"
#include "holdfast/pipeline/health_monitor.hpp"
#include "holdfast/tracking/image_depth.hpp"
#include "holdfast/tracking/metric_scale.hpp"
#include "holdfast/tracking/no_depth.hpp"
#include "holdfast/tracking/pair_depth.hpp"
#include "holdfast/tracking/tracker.hpp"
#include "keyframe_flow.hpp"

namespace holdfast {

namespace {

PipelineParts checked(PipelineParts parts) {
  HOLDFAST_CHECK(parts.features != nullptr && parts.optimizer != nullptr,
                 "features " << (parts.features != nullptr) << " optimizer " << (parts.optimizer != nullptr));
  if (parts.segmenter == nullptr) parts.segmenter = std::make_unique<NullSegmenter>();
  if (parts.matcher == nullptr) parts.matcher = std::make_unique<NearestMatcher>();
  if (parts.loop_detector == nullptr) parts.loop_detector = std::make_unique<NullLoopDetector>();
  return parts;
}

/// All modules of a pipeline, in the order of a configuration.
std::vector<const Module*> modules_of(const PipelineParts& parts) {
  std::vector<const Module*> modules = {parts.features.get(), parts.matcher.get(), parts.segmenter.get()};
  for (const auto& [name, filter] : parts.filters) modules.push_back(filter.get());
  modules.insert(modules.end(), {parts.optimizer.get(), parts.loop_detector.get()});
  for (const auto& observer : parts.observers) modules.push_back(observer.get());
  return modules;
}

bool has_segmenter(const PipelineParts& parts) {
  return dynamic_cast<const NullSegmenter*>(parts.segmenter.get()) == nullptr;
}

/// Whether filters and masks compare the depth of every frame.
bool needs_depth_images(const PipelineParts& parts) { return has_segmenter(parts) || !parts.filters.empty(); }

MovingWorldParts moving_world_parts(PipelineParts& parts) {
  FilterChain chain(parts.evidence);
  for (auto& [name, filter] : parts.filters) chain.add(name, std::move(filter));
  return {.camera = parts.camera,
          .filters = std::move(chain),
          .segmenter = has_segmenter(parts) ? parts.segmenter.get() : nullptr,
          .segmentation = parts.segmentation,
          .threaded = parts.run.threaded(),
          .has_depth = parts.has_dense_depth()};
}

/// Makes the calibration of a pair that corrects itself, or nothing.
std::unique_ptr<StereoCalibration> calibration_of_pair(const PipelineParts& parts) {
  const StereoSettings& s = parts.stereo;
  if (parts.sensor != Sensor::stereo || s.self_calibration == SelfCalibration::off) return nullptr;
  return std::make_unique<StereoCalibration>(
      parts.camera,
      PairErrors{{s.rotation_x, s.rotation_y, s.rotation_z}, s.focal_ratio, s.column_offset, s.radial, s.decentring},
      s.self_calibration == SelfCalibration::estimated);
}

std::unique_ptr<DepthProvider> depth_provider(const PipelineParts& parts, StereoCalibration* calibration) {
  if (parts.sensor == Sensor::rgbd) return std::make_unique<ImageDepth>(parts.camera, parts.tracking.depth_edge_ratio);
  if (!features_have_depth(parts.sensor)) return std::make_unique<NoDepth>();
  return std::make_unique<PairDepth>(parts.camera, StereoParts{.settings = parts.stereo,
                                                               .right_features = parts.right_features.get(),
                                                               .is_dense = needs_depth_images(parts),
                                                               .dense = parts.dense_stereo.get(),
                                                               .calibration = calibration});
}

/// Throws InputError for inertial measurements that are not finite, or not in temporal order.
void check_imu(const SensorFrame& frame) {
  for (std::size_t i = 0; i < frame.imu.size(); ++i) {
    const ImuSample& sample = frame.imu[i];
    const std::string which = "its inertial measurement " + std::to_string(i);
    if (!std::isfinite(sample.timestamp) || !sample.angular_velocity.allFinite() || !sample.acceleration.allFinite())
      throw InputError({"frame " + std::to_string(frame.index)}, which + " is not finite; expected finite numbers");
    if (i > 0 && !(frame.imu[i - 1].timestamp < sample.timestamp))
      throw InputError({"frame " + std::to_string(frame.index)},
                       which + " does not follow the one before it in time; expected time stamps that rise strictly");
  }
}

const FreeSpace& required(const std::shared_ptr<const FreeSpace>& space) {
  if (!space) throw Error("the pipeline has no surface to ask for free space; set surface.enabled");
  return *space;
}

}  // namespace

/// The facade's parts: what a frame passes through (tracker), and what its keyframes do (flow).
struct Pipeline::State {
  explicit State(PipelineParts given)
      : parts(std::move(given)),
        modules(modules_of(parts)),
        map(std::move(parts.map)),
        moving_world(moving_world_parts(parts), map.unshared()),
        detector(*parts.loop_detector),
        calibration(calibration_of_pair(parts)),
        depth(depth_provider(parts, calibration.get())),
        tracker(parts.tracking,
                {parts.camera, *parts.features, *depth, *parts.optimizer, detector, moving_world, map.unshared(),
                 parts.run.seed, *parts.matcher, parts.imu},
                default_first_poses(surface_poses())),
        flow(parts, map, moving_world, detector) {
    Map& whole = map.unshared();
    whole.set_sensor(parts.sensor);
    whole.set_features({parts.features_name, parts.features->descriptor_type()});
    if (keeps_classes()) whole.set_classes(parts.segmenter->classes());
    whole.set_evidence_limit(static_cast<float>(parts.evidence.limit));
    if (calibration) flow.calibrate_pair(*calibration);
    if (parts.imu && parts.tracking.inertia && parts.mapping.inertia && !parts.localise_only) {
      inertia.emplace(*parts.imu, whole.next_sequence());
      flow.use_inertia(*inertia);
    }
    for (const auto& observer : parts.observers) observer->on_start(parts.segmenter->classes());
    if (parts.localise_only)
      tracker.localise_only();
    else if (parts.run.threaded())
      flow.start_threads();
  }

  /// The method of `surface.poses`; none without it.
  DepthAlignment surface_poses() {
    if (!parts.surface.enabled || !parts.surface.poses) return {};
    return [this](const Frame& frame, const Eigen::Isometry3d& predicted, StageTimes& times) {
      return flow.align_with_surface(frame, predicted, times);
    };
  }
  /// Whether one camera's map is finished and inertial measurements have not scaled it to metres.
  bool has_own_unit() const {
    const Map& whole = map.unshared();
    return finished && !parts.localise_only && parts.imu && parts.tracking.inertia && !whole.keyframes().empty() &&
           !is_metric(whole);
  }
  bool keeps_classes() const { return !parts.segmenter->classes().empty() && !parts.localise_only; }
  /// Throws InputError for a frame that cannot be processed; it leaves no trace: the next one may have its stamp.
  void accept(const SensorFrame& frame);
  void check_stamp(const SensorFrame& frame) const;
  void keep_imu(const SensorFrame& frame);
  /// Notes a frame whose pose drifts: odometry does so too, and follows people where hardly anything else is seen.
  void note_bridge(const FrameResult& result) {
    const bool drifts = result.status == TrackingStatus::inertial || result.fallback == TrackingFallback::odometry;
    if (inertia && drifts) (result.is_keyframe ? unplaced.keyframes : unplaced.frames).push_back(result.timestamp);
  }
  /// Estimates the unit of one camera's map by all inertial measurements. The map can be read meanwhile.
  void estimate_metres() HOLDFAST_EXCLUDES(map);
  /// Adjusts the map a last time, which frames follow.
  void adjust_at_end() HOLDFAST_EXCLUDES(map);
  /// After the last adjustment of the map, which places keyframes.
  void smooth_by_inertia() HOLDFAST_EXCLUDES(map);
  void smooth_trajectory() HOLDFAST_EXCLUDES(map);
  /// Scales the finished map to metres and classifies its points.
  void complete_map() HOLDFAST_EXCLUDES(map);
  /// What the sensor of this pipeline has of a frame, in colour where a part needs that.
  SensorFrame used_images(const SensorFrame& given) const;
  /// Gives the frame that is tracked the depth image of its pair, if there is one and something needs it.
  void add_depth(SensorFrame& frame, bool is_needed, StageTimes& times) {
    if (!is_needed) return;
    const StageTimer timer(times, "frame");
    depth->add_image(frame);
  }
  bool is_start_refuted() HOLDFAST_EXCLUDES(map);
  /// Tracks the frame and inserts it as a keyframe if it is due. In `first_keyframe` the first view of one camera's map
  /// that was inserted before it, invalid otherwise.
  MapRequest track(SensorFrame& frame, FrameResult& result, KeyFrameId& first_keyframe) HOLDFAST_EXCLUDES(map);
  KeyFrameId insert_keyframe(const LockedMap& locked, const MapRequest& request, FrameResult& result)
      HOLDFAST_REQUIRES(map);
  /// Whether tracking goes on while the keyframe just inserted is refined.
  bool is_refined_later() const { return flow.is_threaded() || moving_world.expects_masks(); }
  /// Removes the whole map, which began wrong, from every part that knows of it.
  void give_map_up(StageTimes& times) {
    flow.remove_map([this](const LockedMap& locked) { tracker.forget_map(locked); }, times);
    if (inertia) inertia->forget_map();
  }

  PipelineParts parts;
  std::vector<const Module*> modules;  // see modules_of(); filters move from the parts into the chain
  GuardedMap map;
  MovingWorld moving_world;
  SharedLoopDetector detector;
  std::unique_ptr<StereoCalibration> calibration;  // of a pair whose calibration is corrected
  std::unique_ptr<DepthProvider> depth;
  Tracker tracker;
  bool finished = false;
  bool has_frame = false;
  double last_timestamp = 0.0;
  HealthMonitor health;
  Stopwatch since_start;                   ///< the clock of health
  std::vector<ImuSample> imu;              ///< the first minutes, for warnings
  std::optional<InertialHistory> inertia;  ///< for adjustments
  UnplacedFrames unplaced;                 ///< for the smoothing at the end
  std::vector<double> stamps;              ///< of all frames, for the same [s]
  std::atomic<bool> is_interrupted{false};
  KeyframeFlow flow;  // last: its threads end before the others go
};

void Pipeline::State::accept(const SensorFrame& frame) {
  check_stamp(frame);
  check_imu(frame);
  tracker.check_images(frame);
  keep_imu(frame);
  if (inertia) stamps.push_back(frame.timestamp);
  has_frame = true;
  last_timestamp = frame.timestamp;
}

void Pipeline::State::check_stamp(const SensorFrame& frame) const {
  if (!std::isfinite(frame.timestamp))
    throw InputError({"frame " + std::to_string(frame.index)},
                     "its time stamp is not a finite number; expected seconds that rise from frame to frame");
  if (has_frame && !(frame.timestamp > last_timestamp)) {
    char text[128];
    std::snprintf(text, sizeof(text), "time stamp %.6f does not follow %.6f; stamps must rise strictly",
                  frame.timestamp, last_timestamp);
    throw InputError({"frame " + std::to_string(frame.index)}, text);
  }
}

void Pipeline::State::keep_imu(const SensorFrame& frame) {
  constexpr std::size_t most = 30000;
  if (inertia) inertia->add(frame);
  if (!parts.imu || !parts.checks_imu) return;
  if (imu.size() < most) append_imu(imu, frame.imu);
}

SensorFrame Pipeline::State::used_images(const SensorFrame& given) const {
  // Tracking and mapping need grey alone.
  const bool shows_colour = moving_world.expects_masks() || moving_world.weights_features() ||
                            !parts.observers.empty() || flow.static_scene() != nullptr;
  // An image without pixels has the type of a grey one; tracking refuses it.
  const bool gets_channels = shows_colour && !given.colour.empty() && given.colour.type() == CV_8UC1;
  SensorFrame used = given;
  if (parts.sensor != Sensor::rgbd) used.depth.release();
  if (parts.sensor != Sensor::stereo) used.right.release();
  if (gets_channels) {
    used.colour = cv::Mat();
    cv::merge(std::vector<cv::Mat>(3, given.colour), used.colour);
  }
  return used;
}

bool Pipeline::State::is_start_refuted() {
  const LockedMap locked(map, LockPriority::tracking);
  return tracker.judge_start(locked);
}

MapRequest Pipeline::State::track(SensorFrame& frame, FrameResult& result, KeyFrameId& first_keyframe) {
  const Stopwatch watch;
  tracker.begin(frame, result);
  add_depth(frame, needs_depth_images(parts), result.times);
  const LockedMap locked(map, LockPriority::tracking);
  const MapRequest request = tracker.locate(locked, frame, result);
  result.tracking_seconds += watch.seconds();
  // The two views that begin a map are needed: without them there is nothing to track by.
  if (result.is_keyframe && request.two_views == nullptr) result.is_keyframe = flow.has_room_for_keyframe();
  if (result.is_keyframe) first_keyframe = insert_keyframe(locked, request, result);
  return request;
}

KeyFrameId Pipeline::State::insert_keyframe(const LockedMap& locked, const MapRequest& request, FrameResult& result) {
  // Without a map, or with little of it in view, there is nothing to track by until the mask comes, which takes the
  // points on people back. Right after a loss, people are what hides the map, and tracking would follow them.
  const bool shows_little = result.inliers < parts.segmentation.new_view_share * result.static_features;
  const bool is_new_view = result.status == TrackingStatus::initialised || (shows_little && !request.follows_loss);
  const bool waits_for_mask = moving_world.expects_masks() && !is_new_view;
  KeyFrameId first_keyframe;
  if (request.two_views != nullptr) {
    std::vector<MapPointId> points;
    first_keyframe = flow.begin_map(locked, *request.two_views, points, result.times);
    tracker.map_begun(locked, first_keyframe, points);
  }
  const std::uint32_t submap = request.kind == MapRequest::Kind::new_submap ? locked->new_submap() : request.submap;
  if (inertia) inertia->set_estimates(tracker.inertia_of(locked, submap), submap);
  result.keyframe = flow.insert(locked, tracker.frame(), waits_for_mask, submap, result.times);
  locked->keyframe(result.keyframe).vertical = tracker.vertical(locked);
  if (is_refined_later()) tracker.keyframe_added(locked, result.keyframe);
  return first_keyframe;
}

void Pipeline::State::estimate_metres() {
  if (!inertia) return;
  RunPath path;
  {
    const LockedMap locked(map, LockPriority::background);
    if (is_metric(locked.map())) return;
    path = tracker.path_of_run(locked, *inertia);
  }
  std::optional<MapInertia> estimates;
  flow.in_background([&](StageTimes& times) {
    const StageTimer timer(times, "metric scale");
    estimates =
        holdfast::estimate_metres(path, unplaced, *inertia, inertia->estimates(), *parts.optimizer, is_interrupted);
  });
  if (!estimates) return;
  const LockedMap locked(map, LockPriority::background);
  locked->set_inertia(estimates);
  inertia->set_estimates(estimates, inertia->submap());
}

void Pipeline::State::adjust_at_end() {
  // After a loop's own adjustment the last one changes little: frames then stay relative to their reference keyframes.
  const bool is_large = inertia || parts.mapping.final_rounds > 0;
  PlacedFrames before;
  if (is_large) {
    const LockedMap locked(map, LockPriority::background);
    before = tracker.placed_frames(locked);
  }
  if (!flow.adjust_at_end() || !is_large) return;
  const LockedMap locked(map, LockPriority::background);
  tracker.follow_keyframes(locked, before);  // also where it was interrupted after an adjustment
}

void Pipeline::State::smooth_by_inertia() {
  if (!inertia) return;
  const std::vector<double> placed = flow.placed_keyframes();
  std::erase_if(unplaced.keyframes,
                [&](double stamp) { return std::find(placed.begin(), placed.end(), stamp) != placed.end(); });
  const LockedMap locked(map, LockPriority::background);
  const std::optional<MapInertia> adjusted = inertia->estimates();
  if (adjusted && locked->inertia()) locked->set_inertia(adjusted);  // belongs to the poses, interrupted or not
  if (is_interrupted) return;
  unplaced.longest_gap = parts.tracking.inertial_time;
  for (const double stamp : stamps)
    if (!tracker.pose_at(locked, stamp)) unplaced.missing.push_back(stamp);
  tracker.smooth_by_inertia(locked, unplaced, *inertia, *parts.optimizer, is_interrupted);
}

void Pipeline::State::smooth_trajectory() {
  if (is_interrupted) return;
  const LockedMap locked(map, LockPriority::background);
  flow.in_background([&](StageTimes& times) { tracker.smooth_trajectory(locked, times); });
}

void Pipeline::State::complete_map() {
  const LockedStructure structure(map);
  const LockedMap locked(map, LockPriority::background);
  if (!parts.localise_only) make_metric(locked.map());
  if (keeps_classes()) locked->classify_points();
}

Pipeline::Pipeline(PipelineParts parts) : state_(std::make_unique<State>(checked(std::move(parts)))) {}
Pipeline::~Pipeline() {
  if (state_) interrupt();
}
Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;

std::string Pipeline::segmenter_description() const { return state_->parts.segmenter->description(); }

void Pipeline::finish_loading() { state_->parts.segmenter->finish_loading(); }

FrameResult Pipeline::feed(const SensorFrame& given) {
  State& s = *state_;
  SensorFrame frame = s.used_images(given);
  s.accept(frame);
  s.flow.rethrow_failures();
  s.flow.wait_for_room();

  FrameResult result;
  s.moving_world.next_frame(frame.timestamp);
  s.flow.hand_on_waiting_keyframes();
  const double mask_seconds = s.flow.take_masks(result.times);
  if (s.is_start_refuted()) s.give_map_up(result.times);
  result.tracking_seconds = mask_seconds;
  KeyFrameId first_keyframe;
  const MapRequest request = s.track(frame, result, first_keyframe);
  // Without the map's lock.
  s.add_depth(frame, result.is_keyframe && (s.parts.dense_map.enabled || s.parts.surface.enabled), result.times);
  if (request.kind == MapRequest::Kind::give_up) s.give_map_up(result.times);
  if (first_keyframe.valid()) s.flow.refine_without_mask(first_keyframe, result.times);
  s.flow.request_mask(frame, s.tracker.frame(), request.wants_mask, result, result.times);
  if (result.is_keyframe) {
    if (!s.is_refined_later()) {
      const LockedMap locked(s.map, LockPriority::tracking);
      s.tracker.keyframe_added(locked, result.keyframe);
    }
    result.T_world_camera = s.tracker.frame().T_world_camera();
  }
  result.tracking_seconds += s.flow.take_masks(result.times);  // this frame's own, when there is no latency
  s.note_bridge(result);
  s.health.add(result, s.since_start.seconds());
  for (const auto& observer : s.parts.observers) observer->on_frame(frame, s.tracker.frame(), result);
  return result;
}

void Pipeline::finish() {
  State& s = *state_;
  if (s.finished) return;
  s.flow.finish();
  s.finished = true;
  s.health.finish();
  s.flow.rethrow_failures();
  {
    const LockedMap locked(s.map, LockPriority::background);
    s.flow.in_background([&](StageTimes& times) { s.tracker.finish(locked, times, s.is_interrupted); });
    const std::uint32_t submap = s.tracker.main_submap(locked);
    const std::optional<MapInertia> estimates = s.tracker.inertia_of(locked, submap);
    if (!s.parts.localise_only) locked->set_inertia(estimates);
    if (s.inertia) s.inertia->set_estimates(estimates, submap);
    s.flow.keep_submap(locked, submap);
  }
  s.estimate_metres();
  s.adjust_at_end();
  s.smooth_by_inertia();
  s.smooth_trajectory();
  s.complete_map();
  s.flow.finish_surface();
  for (const auto& observer : s.parts.observers) observer->on_finish(s.map.unshared());
}

PipelineHealth Pipeline::health(double patience) const {
  return state_->health.health(state_->since_start.seconds(), patience);
}

void Pipeline::interrupt() {
  state_->is_interrupted = true;
  state_->flow.request_stop();
  for (const auto& observer : state_->parts.observers) observer->interrupt();
}

std::vector<StageTimes> Pipeline::take_background_times() {
  std::vector<StageTimes> times = state_->flow.take_background_times();
  for (StageTimes& more : state_->moving_world.take_times()) times.push_back(std::move(more));
  return times;
}

const MaskCounts& Pipeline::mask_counts() const { return state_->moving_world.mask_counts(); }

const std::vector<double>& Pipeline::mask_latencies() const { return state_->moving_world.mask_latencies(); }

std::uint64_t Pipeline::keyframes_deferred() const { return state_->flow.keyframes_deferred(); }

std::vector<WorkerCounts> Pipeline::worker_counts() const { return state_->flow.worker_counts(); }

Trajectory Pipeline::trajectory() const {
  const LockedMap locked(state_->map, LockPriority::tracking);
  return state_->tracker.trajectory(locked);
}

Trajectory Pipeline::poses_at(const std::vector<double>& timestamps) const {
  const LockedMap locked(state_->map, LockPriority::tracking);
  Trajectory poses;
  for (const double timestamp : timestamps)
    if (const auto T_world_camera = state_->tracker.pose_at(locked, timestamp))
      poses.push_back({timestamp, *T_world_camera});
  return poses;
}

Trajectory Pipeline::keyframe_trajectory() const {
  const LockedMap locked(state_->map, LockPriority::tracking);
  return holdfast::keyframe_trajectory(locked.map());
}

MapSnapshot Pipeline::map_snapshot() const { return state_->flow.snapshot(); }

void Pipeline::save_map(const std::filesystem::path& file) const {
  const LockedStructure structure(state_->map);
  const LockedMap locked(state_->map, LockPriority::background);
  if (locked->keyframes().empty()) throw Error("there is no map yet to be saved in " + file.string());
  write_map(file, locked.map(), state_->tracker.main_submap(locked));
}

const Map& Pipeline::map() const { return state_->map.unshared(); }
Map Pipeline::take_map() {
  HOLDFAST_CHECK(!state_->flow.is_threaded() || state_->finished, "the threads still use the map; call finish() first");
  return std::exchange(state_->map.unshared(), Map());
}
const StaticScene* Pipeline::static_scene() const { return state_->flow.static_scene(); }
const SurfaceMap* Pipeline::surface() const { return state_->flow.surface(); }
std::shared_ptr<const FreeSpace> Pipeline::free_space() const { return state_->flow.free_space(); }
bool Pipeline::with_surface(const std::function<void(const SurfaceMap&)>& look) const {
  return state_->flow.with_surface(look);
}
bool Pipeline::is_free(const Eigen::Vector3d& point) const { return required(free_space()).is_free(point); }
double Pipeline::distance(const Eigen::Vector3d& point) const { return required(free_space()).distance(point); }
const MappingCounts& Pipeline::mapping_counts() const { return state_->flow.mapping_counts(); }
LoopRecord Pipeline::loop_record() const { return state_->flow.loop_record(); }
Warnings Pipeline::warnings() const {
  Warnings warnings = state_->parts.warnings;
  if (const auto& imu = state_->parts.imu)
    for (std::string& suspicion :
         imu_suspicions(state_->imu, {imu->rate, imu->gyroscope_range, imu->accelerometer_range}))
      add_warning(warnings, {{"SensorFrame::imu"}, std::move(suspicion)});
  if (state_->has_own_unit())
    add_warning(warnings, {{"tracking.inertia"},
                           "inertial measurements gave no scale: the map keeps its own unit of length. They need five "
                           "seconds of tracked frames in which the camera accelerates"});
  for (const Module* module : state_->modules) add_warnings(warnings, module->warnings());
  return warnings;
}
LossRecord Pipeline::loss_record() const {
  const LockedMap locked(state_->map, LockPriority::tracking);
  return state_->tracker.loss_record(locked);
}
Sensor Pipeline::sensor() const { return state_->parts.sensor; }
std::optional<PairEstimate> Pipeline::pair_calibration() const {
  if (!state_->calibration) return std::nullopt;
  return state_->calibration->estimate();
}
double Pipeline::readout() const {
  const RollingShutter& shutter = state_->tracker.rolling_shutter();
  return shutter.is_active() ? shutter.readout() : 0.0;
}
const Camera& Pipeline::camera() const { return state_->parts.camera; }

}  // namespace holdfast
