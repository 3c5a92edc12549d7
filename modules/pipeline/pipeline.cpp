// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/pipeline/pipeline.hpp"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <mutex>
#include <optional>

#include "holdfast/core/error.hpp"
#include "holdfast/core/map_mutex.hpp"
#include "holdfast/dense_map/static_scene.hpp"
#include "holdfast/map_io/map_export.hpp"
#include "holdfast/pipeline/segmentation_desk.hpp"
#include "holdfast/tracking/filter_chain.hpp"
#include "holdfast/tracking/tracker.hpp"

namespace holdfast {

namespace {

/// What the loop closing thread works on: a keyframe that local mapping is done with, and those that it removed.
struct LoopJob {
  KeyFrameId keyframe;
  std::vector<KeyFrameId> removed;
};

/// What the full adjustment thread works on: the whole map.
struct AdjustmentJob {};

PipelineParts checked(PipelineParts parts) {
  HOLDFAST_CHECK(parts.features != nullptr && parts.optimizer != nullptr,
                 "features " << (parts.features != nullptr) << " optimizer " << (parts.optimizer != nullptr));
  if (parts.segmenter == nullptr) parts.segmenter = std::make_unique<NullSegmenter>();
  if (parts.loop_detector == nullptr) parts.loop_detector = std::make_unique<NullLoopDetector>();
  return parts;
}

FilterChain chain_of(PipelineParts& parts) {
  FilterChain chain(parts.evidence);
  for (auto& [name, filter] : parts.filters) chain.add(name, std::move(filter));
  return chain;
}

}  // namespace

struct Pipeline::State {
  explicit State(PipelineParts given)
      : parts(std::move(given)),
        map(std::move(parts.map)),
        filters(chain_of(parts)),
        detector(*parts.loop_detector),
        tracker(parts.tracking, parts.camera, *parts.features, *parts.optimizer, filters, detector, map, parts.seed),
        mapper(parts.mapping, map, map_mutex, *parts.optimizer),
        closer(parts.loop_closing, map, map_mutex, surgery, detector, *parts.optimizer, parts.seed),
        adjustment(parts.loop_closing, map, map_mutex, surgery, *parts.optimizer) {
    closer.set_full_adjustment(&adjustment);
    for (const KeyFrameId keyframe : map.keyframes_by_age())
      detector.add(keyframe, map.keyframe(keyframe).frame.features.descriptors);
    if (dynamic_cast<NullSegmenter*>(parts.segmenter.get()) == nullptr) {
      tracker.expect_masks(*parts.segmenter, parts.segmentation.memory);
      segmentation.emplace(*parts.segmenter, parts.segmentation, parts.threads.threaded);
    }
    if (parts.dense_map.enabled && !parts.localise_only) scene.emplace(parts.camera, parts.dense_map);
    for (const std::string& name : parts.segmenter->classes()) {
      const std::vector<std::string>& out = parts.dense_map.classes;
      left_out.push_back(std::find(out.begin(), out.end(), name) != out.end());
    }
    if (parts.localise_only)
      tracker.localise_only();
    else if (parts.threads.threaded)
      start_threads();
  }

  void start_threads();
  void check_stamp(const SensorFrame& frame);
  LoopJob refine(KeyFrameId keyframe, StageTimes& times);
  /// True when a loop was closed and the whole map should be adjusted.
  bool close_loops(const LoopJob& job, StageTimes& times);
  void adjust_map(StageTimes& times);
  /// Gives the masks that have come to the tracker, and the keyframes that waited for them to mapping.
  void take_masks(StageTimes& times);
  /// Asks for the mask of the frame last tracked, if it should have one. A keyframe that cannot be segmented now goes
  /// on without.
  void ask_for_mask(const SensorFrame& frame, const FrameResult& result, StageTimes& times);
  /// `coarse` and `labels` (may be empty) are the last that will be known of what moves in the keyframe.
  void keep_view(KeyFrameId keyframe, const SensorFrame& frame, const CoarseView& coarse, const cv::Mat& labels,
                 StageTimes& times);
  void hand_to_mapping(KeyFrameId keyframe, StageTimes& times);
  /// Does work that fills stage times, and keeps them for take_background_times().
  template <class Work>
  void in_background(const Work& work) {
    StageTimes times;
    work(times);
    const std::lock_guard lock(record_mutex);
    background_times.push_back(std::move(times));
  }
  void rethrow_failures();

  PipelineParts parts;
  Map map;
  MapMutex map_mutex;
  std::mutex surgery;  // held by whoever moves or removes things in the map; before map_mutex
  FilterChain filters;
  SharedLoopDetector detector;
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
  std::uint64_t frames_fed = 0;
  std::vector<double> mask_latencies;
  std::optional<StaticScene> scene;
  std::vector<bool> left_out;  // of the static scene, by label

  mutable std::mutex record_mutex;
  std::vector<StageTimes> background_times;
  LoopRecord loop_record;

  // Threads last: they use everything above, and each hands its work on to the one before it here.
  std::optional<Worker<AdjustmentJob>> full_adjustment;
  std::optional<Worker<LoopJob>> loop_closing;
  std::optional<Worker<KeyFrameId>> mapping;
  std::optional<SegmentationDesk> segmentation;
};

void Pipeline::State::start_threads() {
  const std::size_t capacity = parts.threads.keyframe_queue;
  full_adjustment.emplace("full adjustment", 1,
                          [this](AdjustmentJob&) { in_background([&](StageTimes& times) { adjust_map(times); }); });
  loop_closing.emplace("loop closing", capacity, [this](LoopJob& job) {
    bool closed = false;
    in_background([&](StageTimes& times) { closed = close_loops(job, times); });
    if (closed) full_adjustment->queue().push_newest({});
  });
  mapping.emplace("local mapping", capacity, [this](KeyFrameId& keyframe) {
    LoopJob job;
    in_background([&](StageTimes& times) { job = refine(keyframe, times); });
    loop_closing->queue().push(std::move(job));
  });
}

void Pipeline::State::rethrow_failures() {
  if (mapping) mapping->rethrow();
  if (loop_closing) loop_closing->rethrow();
  if (full_adjustment) full_adjustment->rethrow();
  if (segmentation) segmentation->rethrow();
}

void Pipeline::State::check_stamp(const SensorFrame& frame) {
  if (has_frame && !(frame.timestamp > last_timestamp)) {
    char text[128];
    std::snprintf(text, sizeof(text), "time stamp %.6f does not follow %.6f; stamps must rise strictly",
                  frame.timestamp, last_timestamp);
    throw InputError({"frame " + std::to_string(frame.index)}, text);
  }
  has_frame = true;
  last_timestamp = frame.timestamp;
}

LoopJob Pipeline::State::refine(KeyFrameId keyframe, StageTimes& times) {
  LoopJob job{keyframe, {}};
  {
    const std::lock_guard surgeon(surgery);
    job.removed = mapper.refine(keyframe, times);
  }
  if (parts.observers.empty()) return job;
  const std::lock_guard lock(map_mutex);
  if (map.find_keyframe(keyframe) == nullptr) return job;
  for (const auto& observer : parts.observers) observer->on_keyframe(keyframe, map);
  return job;
}

bool Pipeline::State::close_loops(const LoopJob& job, StageTimes& times) {
  const std::optional<ClosedLoop> loop = closer.process(job.keyframe, times);
  for (const KeyFrameId id : job.removed) closer.forget(id);
  if (!loop) {
    const std::lock_guard lock(record_mutex);
    loop_record.counts = closer.counts();
    if (!loop_record.loops.empty() && parts.loop_closing.full_adjustment) ++keyframes_since_adjustment;
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
    for (const auto& observer : parts.observers) observer->on_loop(loop->keyframe, loop->candidate, map);
  }
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

void Pipeline::State::hand_to_mapping(KeyFrameId keyframe, StageTimes& times) {
  if (mapping) {
    // Tracking needs the points of this keyframe adjusted soon; an older adjustment has done most of its good.
    if (!parts.threads.unpaced) mapper.request_stop();
    mapping->queue().push(keyframe);
    return;
  }
  if (close_loops(refine(keyframe, times), times)) adjust_map(times);
}

void Pipeline::State::keep_view(KeyFrameId keyframe, const SensorFrame& frame, const CoarseView& coarse,
                                const cv::Mat& labels, StageTimes& times) {
  if (!scene) return;
  const StageTimer timer(times, "dense map: keep");
  scene->add(keyframe, frame, coarse, labels, left_out);
}

void Pipeline::State::take_masks(StageTimes& times) {
  if (!segmentation) return;
  while (std::optional<SegmentedFrame> segmented = segmentation->fetch(frames_fed)) {
    tracker.mask_came(segmented->frame.index, segmented->segmentation);
    mask_latencies.push_back(last_timestamp - segmented->frame.timestamp);
    if (!segmented->keyframe.valid()) continue;
    {
      const TrackingLock lock(map_mutex);
      tracker.judge_keyframe(segmented->frame, segmented->segmentation, segmented->keyframe);
      if (const KeyFrame* keyframe = map.find_keyframe(segmented->keyframe))
        keep_view(segmented->keyframe, segmented->frame, keyframe->frame.coarse, segmented->segmentation.labels, times);
    }
    hand_to_mapping(segmented->keyframe, times);
  }
  tracker.hold_keyframes(segmentation->is_full());
}

void Pipeline::State::ask_for_mask(const SensorFrame& frame, const FrameResult& result, StageTimes& times) {
  if (segmentation && (result.is_keyframe || segmentation->wants(frames_fed)) && segmentation->has_room()) {
    tracker.await_mask();
    segmentation->hand_in(frame, result.is_keyframe ? result.keyframe : KeyFrameId(), times);
    tracker.hold_keyframes(segmentation->is_full());
  } else if (result.is_keyframe) {
    keep_view(result.keyframe, frame, tracker.frame().coarse, {}, times);
    hand_to_mapping(result.keyframe, times);
  }
}

Pipeline::Pipeline(PipelineParts parts) : state_(std::make_unique<State>(checked(std::move(parts)))) {}
Pipeline::~Pipeline() {
  if (state_) interrupt();
}
Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;

FrameResult Pipeline::feed(const SensorFrame& frame) {
  State& s = *state_;
  s.check_stamp(frame);
  s.rethrow_failures();
  if (s.mapping && s.parts.threads.unpaced) s.mapping->queue().wait_for_room();

  FrameResult result;
  s.take_masks(result.times);
  const Stopwatch watch;
  s.tracker.begin(frame, result);
  {
    const TrackingLock lock(s.map_mutex);
    s.tracker.locate(frame, result);
    result.tracking_seconds = watch.seconds();
    if (result.is_keyframe && s.mapping && !s.mapping->queue().has_room()) {
      result.is_keyframe = false;
      ++s.keyframes_deferred;
    }
    if (result.is_keyframe) {
      // Without a map there is nothing to track by until the mask comes: the first keyframe's points cannot wait.
      const bool wait_for_mask = s.segmentation && result.status != TrackingStatus::initialised;
      result.keyframe = s.mapper.insert(s.tracker.frame(), wait_for_mask, result.times);
      if (s.mapping || s.segmentation) s.tracker.keyframe_added(result.keyframe);
    }
  }
  s.ask_for_mask(frame, result, result.times);
  if (result.is_keyframe) {
    if (!s.mapping && !s.segmentation) s.tracker.keyframe_added(result.keyframe);
    result.T_world_camera = s.tracker.frame().T_world_camera();
  }
  s.take_masks(result.times);  // this frame's own, when there is no latency
  ++s.frames_fed;
  for (const auto& observer : s.parts.observers) observer->on_frame(frame, s.tracker.frame(), result);
  return result;
}

void Pipeline::finish() {
  State& s = *state_;
  // In the order in which work is handed on, so that nothing is left behind.
  if (s.segmentation) {
    s.segmentation->finish();
    s.segmentation->rethrow();
    s.in_background([&](StageTimes& times) { s.take_masks(times); });
  }
  if (s.mapping) s.mapping->finish();
  if (s.loop_closing) s.loop_closing->finish();
  if (s.full_adjustment) s.full_adjustment->finish();
  s.finished = true;
  s.rethrow_failures();
  // What was seen after the last loop ties its two ends together further: the result deserves it.
  if (s.keyframes_since_adjustment > 0 && !s.interrupted)
    s.in_background([&](StageTimes& times) { s.adjust_map(times); });
  for (const auto& observer : s.parts.observers) observer->on_finish(s.map);
}

void Pipeline::interrupt() {
  state_->interrupted = true;
  state_->mapper.request_stop();
  state_->adjustment.request_stop();
}

std::vector<StageTimes> Pipeline::take_background_times() {
  const std::lock_guard lock(state_->record_mutex);
  std::vector<StageTimes> times = std::exchange(state_->background_times, {});
  if (state_->segmentation)
    for (StageTimes& more : state_->segmentation->take_times()) times.push_back(std::move(more));
  return times;
}

const std::vector<double>& Pipeline::mask_latencies() const { return state_->mask_latencies; }

std::uint64_t Pipeline::keyframes_deferred() const { return state_->keyframes_deferred; }

std::vector<WorkerCounts> Pipeline::worker_counts() const {
  std::vector<WorkerCounts> counts;
  if (state_->mapping) counts.push_back(state_->mapping->counts());
  if (state_->loop_closing) counts.push_back(state_->loop_closing->counts());
  if (state_->full_adjustment) counts.push_back(state_->full_adjustment->counts());
  if (state_->segmentation)
    if (const auto segmentation = state_->segmentation->worker_counts()) counts.push_back(*segmentation);
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

MapSnapshot Pipeline::map_snapshot() const {
  const std::lock_guard lock(state_->map_mutex);
  return make_snapshot(state_->map);
}

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
const Camera& Pipeline::camera() const { return state_->parts.camera; }

}  // namespace holdfast
