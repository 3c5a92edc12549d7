// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/pipeline/pipeline.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <deque>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>

#include "holdfast/core/error.hpp"
#include "holdfast/core/map_mutex.hpp"
#include "holdfast/core/worker.hpp"
#include "holdfast/dense_map/static_scene.hpp"
#include "holdfast/loop_closing/full_adjustment.hpp"
#include "holdfast/loop_closing/loop_closer.hpp"
#include "holdfast/map_io/map_export.hpp"
#include "holdfast/mapping/local_mapper.hpp"
#include "holdfast/matching/frame_features.hpp"
#include "holdfast/moving_world/moving_world.hpp"
#include "holdfast/tracking/tracker.hpp"

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

MovingWorldParts moving_world_parts(PipelineParts& parts) {
  FilterChain chain(parts.evidence);
  for (auto& [name, filter] : parts.filters) chain.add(name, std::move(filter));
  return {.camera = parts.camera,
          .filters = std::move(chain),
          .segmenter = has_segmenter(parts) ? parts.segmenter.get() : nullptr,
          .segmentation = parts.segmentation,
          .threaded = parts.run.threaded(),
          .has_depth = parts.sensor != Sensor::mono};
}

std::optional<StereoParts> stereo_parts(const PipelineParts& parts) {
  if (parts.sensor != Sensor::stereo) return std::nullopt;
  return StereoParts{.settings = parts.stereo,
                     .right_features = parts.right_features.get(),
                     .is_dense = has_segmenter(parts) || !parts.filters.empty()};
}

}  // namespace

struct Pipeline::State {
  /// What the loop closing thread works on: a keyframe that local mapping is done with, and those that it removed.
  struct LoopJob {
    KeyFrameId keyframe;
    std::vector<KeyFrameId> removed;
    cv::Mat image;  // see image_to_describe()
  };

  /// What the mapping thread works on. A keyframe whose mask has not come yet comes again with it, and only then
  /// becomes a place.
  struct MappingJob {
    KeyFrameId keyframe;
    bool is_final = true;
    cv::Mat image = {};  // see image_to_describe()
  };

  /// What the full adjustment thread works on: the whole map.
  struct AdjustmentJob {};

  explicit State(PipelineParts given)
      : parts(std::move(given)),
        modules(modules_of(parts)),
        map(std::move(parts.map)),
        moving_world(moving_world_parts(parts), map),
        detector(*parts.loop_detector),
        describes_images(detector.image_descriptor().has_value()),
        tracker(parts.tracking, {parts.camera, *parts.features, *parts.optimizer, detector, moving_world, map,
                                 parts.run.seed, stereo_parts(parts), parts.sensor != Sensor::mono, *parts.matcher}),
        mapper(parts.mapping, parts.tracking.close_depth_factor, map, map_mutex, *parts.optimizer, *parts.matcher),
        closer(parts.loop_closing, {map, map_mutex, surgery}, detector, *parts.optimizer, parts.run.seed,
               *parts.matcher),
        adjustment(parts.loop_closing, {map, map_mutex, surgery}, *parts.optimizer) {
    map.set_sensor(parts.sensor);
    map.set_features({parts.features_name, parts.features->descriptor_type()});
    if (!parts.segmenter->classes().empty() && !parts.localise_only) map.set_classes(parts.segmenter->classes());
    map.set_evidence_limit(static_cast<float>(parts.evidence.limit));
    if (moving_world.expects_masks()) mapper.expect_masks();
    closer.set_full_adjustment(&adjustment);
    for (const KeyFrameId keyframe : map.keyframes_by_age())
      detector.add(keyframe, place_descriptors(map.keyframe(keyframe).frame, describes_images));
    if (parts.dense_map.enabled && !parts.localise_only) scene.emplace(parts.camera, parts.dense_map);
    for (const std::string& name : parts.segmenter->classes()) {
      const std::vector<std::string>& out = parts.dense_map.classes;
      left_out.push_back(std::find(out.begin(), out.end(), name) != out.end());
    }
    for (const auto& observer : parts.observers) observer->on_start(parts.segmenter->classes());
    if (parts.localise_only)
      tracker.localise_only();
    else if (parts.run.threaded())
      start_threads();
  }

  void start_threads();
  void check_stamp(const SensorFrame& frame) const;
  /// The frame as given, or in `other` what the sensor of this pipeline has of it, in colour where a part needs that.
  const SensorFrame& used_images(const SensorFrame& given, SensorFrame& other) const;
  /// Removes the whole map, which began wrong, from every part that knows of it.
  void give_map_up(StageTimes& times);
  /// Inserts the first of the two keyframes with which the map of one camera begins; the caller holds the map's lock.
  KeyFrameId begin_map(const TwoViewStart& start, StageTimes& times);
  /// Removes the pieces of the map that nothing joined with the main one; the threads have ended.
  void drop_loose_pieces();
  LoopJob refine(const MappingJob& job, StageTimes& times);
  /// The colour image of a keyframe if the loop detector will describe it; otherwise none, so that none is kept.
  cv::Mat image_to_describe(const SensorFrame& frame) const { return describes_images ? frame.colour : cv::Mat(); }
  /// Has the loop detector describe the image of a keyframe without what moves in it. Adds the stage "loops: describe".
  void describe_place(const LoopJob& job, StageTimes& times);
  /// True when a loop was closed and the whole map should be adjusted.
  bool close_loops(const LoopJob& job, StageTimes& times);
  void adjust_map(StageTimes& times);
  /// Applies the masks that have arrived and hands the keyframes that waited for them to mapping. Returns the seconds
  /// that applying them took.
  double take_masks(StageTimes& times);
  /// Requests the mask of the frame last tracked, if it should have one. A keyframe that cannot be segmented now goes
  /// on without a mask.
  void request_mask(const SensorFrame& frame, const FrameResult& result, StageTimes& times);
  /// `coarse` and `labels` (may be empty) are the final evidence of motion in the keyframe. Returns what was kept until
  /// the next call, nullptr without a dense map.
  const KeptView* keep_view(KeyFrameId keyframe, const SensorFrame& frame, const CoarseView& coarse,
                            const cv::Mat& labels, StageTimes& times);
  /// Tells the observers of a kept view, if there is one; the caller holds no lock.
  void show_view(const KeptView* view);
  /// Paced mode never waits here: a keyframe that finds no room is kept and handed on with a later frame.
  void hand_to_mapping(const MappingJob& job, StageTimes& times);
  void hand_on_kept_keyframes();
  /// Does work that fills stage times, and keeps them for take_background_times().
  template <class Work>
  void in_background(const Work& work) {
    StageTimes times;
    work(times);
    const std::lock_guard lock(record_mutex);
    background_times.push_back(std::move(times));
  }
  void rethrow_failures();
  bool begins_on_people() {
    const TrackingLock lock(map_mutex);
    return tracker.is_start_refuted();
  }
  bool has_keyframe(KeyFrameId keyframe) {
    const std::lock_guard lock(map_mutex);
    return map.find_keyframe(keyframe) != nullptr;
  }
  MapSnapshot snapshot() {
    const std::lock_guard lock(map_mutex);
    return make_snapshot(map);
  }
  ObservedMap observed_map() {
    return ObservedMap([this] { return snapshot(); });
  }

  PipelineParts parts;
  std::vector<const Module*> modules;  // see modules_of(); filters move from the parts into the chain
  Map map;
  MapMutex map_mutex;
  std::mutex surgery;  // see SharedMap
  MovingWorld moving_world;
  SharedLoopDetector detector;
  bool describes_images;  // the detector, instead of using descriptors of features
  Tracker tracker;
  LocalMapper mapper;
  LoopCloser closer;
  FullAdjustment adjustment;
  bool finished = false;
  std::atomic<bool> interrupted = false;
  int keyframes_since_adjustment = 0;  // of the whole map; none before the first loop
  bool has_frame = false;
  double last_timestamp = 0.0;
  std::uint64_t keyframes_deferred = 0;
  std::deque<MappingJob> keyframes_kept;  // they have their masks, but mapping had no room
  std::optional<StaticScene> scene;
  std::vector<bool> left_out;  // of the static scene, by label

  mutable std::mutex record_mutex;
  std::vector<StageTimes> background_times;
  LoopRecord loop_record;

  // Threads last: they use everything above, and each hands its work on to the one before it here.
  std::optional<Worker<AdjustmentJob>> full_adjustment;
  std::optional<Worker<LoopJob>> loop_closing;
  std::optional<Worker<MappingJob>> mapping;
};

void Pipeline::State::start_threads() {
  const auto capacity = static_cast<std::size_t>(parts.run.keyframe_queue);
  full_adjustment.emplace("full adjustment", 1,
                          [this](AdjustmentJob&) { in_background([&](StageTimes& times) { adjust_map(times); }); });
  loop_closing.emplace("loop closing", capacity, [this](LoopJob& job) {
    bool closed = false;
    in_background([&](StageTimes& times) { closed = close_loops(job, times); });
    if (closed) full_adjustment->queue().push_newest({});
  });
  mapping.emplace("local mapping", capacity, [this](MappingJob& refined) {
    LoopJob job;
    in_background([&](StageTimes& times) { job = refine(refined, times); });
    loop_closing->queue().push(std::move(job));
  });
}

void Pipeline::State::rethrow_failures() {
  if (mapping) mapping->rethrow();
  if (loop_closing) loop_closing->rethrow();
  if (full_adjustment) full_adjustment->rethrow();
  moving_world.rethrow();
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

const SensorFrame& Pipeline::State::used_images(const SensorFrame& given, SensorFrame& other) const {
  const bool drops_depth = parts.sensor != Sensor::rgbd && !given.depth.empty();
  const bool drops_right = parts.sensor != Sensor::stereo && !given.right.empty();
  // Tracking and mapping need grey alone.
  const bool shows_colour =
      moving_world.expects_masks() || moving_world.weights_features() || !parts.observers.empty() || scene.has_value();
  // An image without pixels has the type of a grey one; tracking refuses it.
  const bool gets_channels = shows_colour && !given.colour.empty() && given.colour.type() == CV_8UC1;
  if (!drops_depth && !drops_right && !gets_channels) return given;
  other = given;
  if (drops_depth) other.depth.release();
  if (drops_right) other.right.release();
  if (gets_channels) {
    other.colour = cv::Mat();
    cv::merge(std::vector<cv::Mat>(3, given.colour), other.colour);
  }
  return other;
}

KeyFrameId Pipeline::State::begin_map(const TwoViewStart& start, StageTimes& times) {
  std::vector<std::pair<Eigen::Vector3d, std::uint32_t>> points;
  for (const TwoViewStart::Point& point : start.points) points.emplace_back(point.position, point.in_reference);
  std::vector<MapPointId> ids;
  const KeyFrameId first = mapper.begin(start.reference, points, ids, times);
  tracker.map_begun(first, ids);
  return first;
}

void Pipeline::State::give_map_up(StageTimes& times) {
  LoopJob job;
  mapper.request_stop();
  {
    const std::lock_guard surgeon(surgery);  // an adjustment that runs counts on its keyframes
    const std::lock_guard lock(map_mutex);
    job.removed = map.keyframes_by_age();
    map.remove_all();
    if (scene) scene->forget_removed(map);
    mapper.forget_map();
    tracker.forget_map();
  }
  keyframes_kept.clear();
  // Mapping and masks find out by themselves that a keyframe is gone.
  if (loop_closing)
    loop_closing->queue().push(std::move(job));
  else
    close_loops(job, times);
}

void Pipeline::State::drop_loose_pieces() {
  const std::lock_guard lock(map_mutex);
  const std::uint32_t main = tracker.main_piece();
  if (map.keyframes_outside(main).empty()) return;
  map.keep_piece(main);
  if (scene) scene->forget_removed(map);
}

Pipeline::State::LoopJob Pipeline::State::refine(const MappingJob& given, StageTimes& times) {
  LoopJob job{given.is_final ? given.keyframe : KeyFrameId(), {}, given.image};
  {
    const std::lock_guard surgeon(surgery);
    job.removed = mapper.refine(given.keyframe, times);
  }
  if (!given.is_final || parts.observers.empty() || !has_keyframe(given.keyframe)) return job;
  const ObservedMap observed = observed_map();
  for (const auto& observer : parts.observers) observer->on_keyframe(given.keyframe, observed);
  return job;
}

void Pipeline::State::describe_place(const LoopJob& job, StageTimes& times) {
  CoarseView coarse;
  {
    const std::lock_guard lock(map_mutex);
    const KeyFrame* keyframe = map.find_keyframe(job.keyframe);
    if (keyframe == nullptr) return;
    coarse.static_log_odds = keyframe->frame.coarse.static_log_odds;
  }
  const StageTimer timer(times, "loops: describe");
  DescriptorBlock place = detector.describe(job.image, moving_world.moving_pixels(coarse));
  const std::lock_guard lock(map_mutex);
  if (KeyFrame* keyframe = map.find_keyframe(job.keyframe)) keyframe->frame.place = std::move(place);
}

bool Pipeline::State::close_loops(const LoopJob& job, StageTimes& times) {
  std::optional<ClosedLoop> loop;
  if (job.keyframe.valid() && !job.image.empty()) describe_place(job, times);
  if (job.keyframe.valid()) loop = closer.process(job.keyframe, times);
  for (const KeyFrameId id : job.removed) closer.forget(id);
  if (!loop) {
    const std::lock_guard lock(record_mutex);
    loop_record.counts = closer.counts();
    if (job.keyframe.valid() && !loop_record.loops.empty() && parts.loop_closing.full_adjustment)
      ++keyframes_since_adjustment;
    return false;
  }
  LoopEvent event{.loop = *loop};
  {
    const std::lock_guard lock(map_mutex);
    const auto stamp_of = [this](KeyFrameId id) {
      const KeyFrame* keyframe = map.find_keyframe(id);
      return keyframe == nullptr ? 0.0 : keyframe->frame.timestamp;
    };
    event.timestamp = stamp_of(loop->keyframe);
    event.candidate_timestamp = stamp_of(loop->candidate);
  }
  const ObservedMap observed = observed_map();
  for (const auto& observer : parts.observers) observer->on_loop(loop->keyframe, loop->candidate, observed);
  const std::lock_guard lock(record_mutex);
  loop_record.counts = closer.counts();
  loop_record.loops.push_back(std::move(event));
  keyframes_since_adjustment = 0;
  return parts.loop_closing.full_adjustment;
}

void Pipeline::State::adjust_map(StageTimes& times) {
  const StageTimer timer(times, "loops: full adjustment");
  const FullAdjustmentSummary summary = adjustment.run();
  const std::lock_guard lock(record_mutex);
  loop_record.adjustments.push_back(summary);
}

void Pipeline::State::hand_to_mapping(const MappingJob& job, StageTimes& times) {
  if (!mapping) {
    if (close_loops(refine(job, times), times)) adjust_map(times);
    return;
  }
  if (!parts.run.paced()) {
    mapping->queue().push(job);
    return;
  }
  // Tracking needs the points of this keyframe adjusted soon; an older adjustment has done most of its good.
  mapper.request_stop();
  if (keyframes_kept.empty() && mapping->queue().has_room()) {
    mapping->queue().push(job);  // no other thread adds to the queue, so that this does not wait
    return;
  }
  if (!job.is_final) return;  // its mask brings it again
  keyframes_kept.push_back(job);
  ++keyframes_deferred;
}

void Pipeline::State::hand_on_kept_keyframes() {
  while (!keyframes_kept.empty() && mapping->queue().has_room()) {
    mapping->queue().push(keyframes_kept.front());
    keyframes_kept.pop_front();
  }
}

const KeptView* Pipeline::State::keep_view(KeyFrameId keyframe, const SensorFrame& frame, const CoarseView& coarse,
                                           const cv::Mat& labels, StageTimes& times) {
  if (!scene) return nullptr;
  const StageTimer timer(times, "dense map: keep");
  return &scene->add(keyframe, frame, coarse, labels, left_out);
}

void Pipeline::State::show_view(const KeptView* view) {
  if (view == nullptr || parts.observers.empty()) return;
  ObservedView observed{.keyframe = view->keyframe, .timestamp = view->timestamp};
  observed.points = [this, view](std::size_t most) { return scene->surface(*view, most); };
  {
    const TrackingLock lock(map_mutex);
    observed.T_world_camera = map.pose_of(view->keyframe).inverse();
  }
  for (const auto& observer : parts.observers) observer->on_static_view(observed);
}

double Pipeline::State::take_masks(StageTimes& times) {
  double seconds = 0.0;
  for (;;) {
    Stopwatch watch;
    const std::optional<ArrivedMask> arrived = moving_world.take_mask(times);
    if (!arrived) return seconds;
    seconds += watch.seconds();
    if (!arrived->keyframe.valid()) continue;
    const KeptView* kept = nullptr;
    {
      watch.restart();
      const TrackingLock lock(map_mutex);
      moving_world.evaluate_keyframe(*arrived, times);
      seconds += watch.seconds();
      if (const KeyFrame* keyframe = map.find_keyframe(arrived->keyframe))
        kept =
            keep_view(arrived->keyframe, arrived->frame, keyframe->frame.coarse, arrived->segmentation.labels, times);
    }
    show_view(kept);
    hand_to_mapping({arrived->keyframe, true, image_to_describe(arrived->frame)}, times);
  }
}

void Pipeline::State::request_mask(const SensorFrame& frame, const FrameResult& result, StageTimes& times) {
  const KeyFrameId keyframe = result.is_keyframe ? result.keyframe : KeyFrameId();
  // One camera looks for its first two views by masks that are as fresh as they can be.
  const bool is_needed =
      (parts.sensor == Sensor::mono && result.status == TrackingStatus::waiting) || tracker.needs_mask();
  const bool is_requested = moving_world.request_mask(frame, keyframe, times, is_needed);
  if (!result.is_keyframe) return;
  if (is_requested) {
    // One camera makes all its points by triangulation, and would be lost before the mask arrives: a propagated mask
    // has to do until then.
    if (parts.sensor == Sensor::mono) hand_to_mapping({keyframe, false}, times);
    return;
  }
  show_view(keep_view(keyframe, frame, tracker.frame().coarse, {}, times));
  hand_to_mapping({keyframe, true, image_to_describe(frame)}, times);
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
  SensorFrame other;
  const SensorFrame& frame = s.used_images(given, other);
  // A frame that is refused leaves no trace: the next one may have its stamp.
  s.check_stamp(frame);
  s.tracker.check_images(frame);
  s.has_frame = true;
  s.last_timestamp = frame.timestamp;
  s.rethrow_failures();
  if (s.mapping && !s.parts.run.paced()) s.mapping->queue().wait_for_room();

  FrameResult result;
  s.moving_world.next_frame(frame.timestamp);
  s.hand_on_kept_keyframes();
  const double mask_seconds = s.take_masks(result.times);
  if (s.begins_on_people()) s.give_map_up(result.times);
  KeyFrameId first_keyframe;
  const Stopwatch watch;
  s.tracker.begin(frame, result);
  {
    const TrackingLock lock(s.map_mutex);
    s.tracker.locate(frame, result);
    result.tracking_seconds = mask_seconds + watch.seconds();
    // The two views that begin a map are needed: without them there is nothing to track by.
    if (result.is_keyframe && s.tracker.two_view_start() == nullptr && s.mapping &&
        (!s.keyframes_kept.empty() || !s.mapping->queue().has_room())) {
      result.is_keyframe = false;
      ++s.keyframes_deferred;
    }
    if (result.is_keyframe) {
      // Without a map, or with little of it in view, there is nothing to track by until the mask comes, which takes the
      // points on people back. Right after a loss, people are what hides the map, and tracking would follow them.
      const bool shows_little = result.inliers < s.parts.segmentation.new_view_share * result.static_features;
      const bool is_new_view =
          result.status == TrackingStatus::initialised || (shows_little && !s.tracker.was_just_found());
      const bool wait_for_mask = s.moving_world.expects_masks() && !is_new_view;
      if (const TwoViewStart* start = s.tracker.two_view_start()) first_keyframe = s.begin_map(*start, result.times);
      const std::uint32_t piece = s.tracker.begins_piece() ? s.map.new_piece() : s.tracker.piece();
      result.keyframe = s.mapper.insert(s.tracker.frame(), wait_for_mask, result.times, piece);
      if (s.mapping || s.moving_world.expects_masks()) s.tracker.keyframe_added(result.keyframe);
    }
  }
  if (s.tracker.gave_map_up()) s.give_map_up(result.times);
  if (first_keyframe.valid()) s.hand_to_mapping({first_keyframe}, result.times);
  s.request_mask(frame, result, result.times);
  if (result.is_keyframe) {
    if (!s.mapping && !s.moving_world.expects_masks()) s.tracker.keyframe_added(result.keyframe);
    result.T_world_camera = s.tracker.frame().T_world_camera();
  }
  result.tracking_seconds += s.take_masks(result.times);  // this frame's own, when there is no latency
  for (const auto& observer : s.parts.observers) observer->on_frame(frame, s.tracker.frame(), result);
  return result;
}

void Pipeline::finish() {
  State& s = *state_;
  // In the order in which work is handed on, so that nothing is left behind.
  if (s.moving_world.expects_masks()) {
    s.moving_world.finish();
    s.in_background([&](StageTimes& times) { s.take_masks(times); });
  }
  for (const State::MappingJob& job : std::exchange(s.keyframes_kept, {})) s.mapping->queue().push(job);
  if (s.mapping) s.mapping->finish();
  if (s.loop_closing) s.loop_closing->finish();
  if (s.full_adjustment) s.full_adjustment->finish();
  s.finished = true;
  s.rethrow_failures();
  s.in_background([&](StageTimes& times) {
    const std::lock_guard lock(s.map_mutex);
    s.tracker.finish(times);
  });
  s.drop_loose_pieces();
  // What was seen after the last loop ties its two ends together further: the result deserves it.
  if (s.keyframes_since_adjustment > 0 && !s.interrupted)
    s.in_background([&](StageTimes& times) { s.adjust_map(times); });
  if (!s.parts.segmenter->classes().empty() && !s.parts.localise_only) s.map.classify_points();
  for (const auto& observer : s.parts.observers) observer->on_finish(s.map);
}

void Pipeline::interrupt() {
  state_->interrupted = true;
  state_->mapper.request_stop();
  state_->adjustment.cancel();
}

std::vector<StageTimes> Pipeline::take_background_times() {
  const std::lock_guard lock(state_->record_mutex);
  std::vector<StageTimes> times = std::exchange(state_->background_times, {});
  for (StageTimes& more : state_->moving_world.take_times()) times.push_back(std::move(more));
  return times;
}

const MaskCounts& Pipeline::mask_counts() const { return state_->moving_world.mask_counts(); }

const std::vector<double>& Pipeline::mask_latencies() const { return state_->moving_world.mask_latencies(); }

std::uint64_t Pipeline::keyframes_deferred() const { return state_->keyframes_deferred; }

std::vector<WorkerCounts> Pipeline::worker_counts() const {
  std::vector<WorkerCounts> counts;
  if (state_->mapping) counts.push_back(state_->mapping->counts());
  if (state_->loop_closing) counts.push_back(state_->loop_closing->counts());
  if (state_->full_adjustment) counts.push_back(state_->full_adjustment->counts());
  if (const auto segmentation = state_->moving_world.worker_counts()) counts.push_back(*segmentation);
  return counts;
}

Trajectory Pipeline::trajectory() const {
  const TrackingLock lock(state_->map_mutex);
  return state_->tracker.trajectory();
}

Trajectory Pipeline::keyframe_trajectory() const {
  const TrackingLock lock(state_->map_mutex);
  return holdfast::keyframe_trajectory(state_->map);
}

MapSnapshot Pipeline::map_snapshot() const { return state_->snapshot(); }

const Map& Pipeline::map() const { return state_->map; }
Map Pipeline::take_map() {
  HOLDFAST_CHECK(!state_->mapping || state_->finished, "the threads still use the map; call finish() first");
  return std::exchange(state_->map, Map());
}
const StaticScene* Pipeline::static_scene() const { return state_->scene ? &*state_->scene : nullptr; }
const MappingCounts& Pipeline::mapping_counts() const { return state_->mapper.counts(); }
LoopRecord Pipeline::loop_record() const {
  const std::lock_guard lock(state_->record_mutex);
  return state_->loop_record;
}
Warnings Pipeline::warnings() const {
  Warnings warnings = state_->parts.warnings;
  for (const Module* module : state_->modules) add_warnings(warnings, module->warnings());
  return warnings;
}
LossRecord Pipeline::loss_record() const {
  const TrackingLock lock(state_->map_mutex);
  return state_->tracker.loss_record();
}
Sensor Pipeline::sensor() const { return state_->parts.sensor; }
double Pipeline::readout() const {
  const RollingShutter& shutter = state_->tracker.rolling_shutter();
  return shutter.is_active() ? shutter.readout() : 0.0;
}
const Camera& Pipeline::camera() const { return state_->parts.camera; }

}  // namespace holdfast
