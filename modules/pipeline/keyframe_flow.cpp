// SPDX-License-Identifier: BSD-3-Clause
#include "keyframe_flow.hpp"

#include <algorithm>
#include <utility>

#include "holdfast/map_io/map_export.hpp"
#include "holdfast/matching/frame_features.hpp"
#include "holdfast/surface/surface_alignment.hpp"

namespace holdfast {

namespace {

/// Releases a mutex that the thread has locked.
class HOLDFAST_SCOPED_CAPABILITY AdoptedLock {
 public:
  explicit AdoptedLock(Mutex& mutex) HOLDFAST_REQUIRES(mutex) : mutex_(mutex) {}
  ~AdoptedLock() HOLDFAST_RELEASE() { mutex_.unlock(); }
  AdoptedLock(const AdoptedLock&) = delete;
  AdoptedLock& operator=(const AdoptedLock&) = delete;

 private:
  Mutex& mutex_;
};

}  // namespace

KeyframeFlow::KeyframeFlow(PipelineParts& parts, GuardedMap& map, MovingWorld& moving_world,
                           SharedLoopDetector& detector)
    : parts_(parts),
      map_(map),
      moving_world_(moving_world),
      detector_(detector),
      describes_images_(detector.image_descriptor().has_value()),
      points_need_parallax_(!features_have_depth(parts.sensor)),
      mapper_(parts.mapping, parts.tracking.close_depth_factor, map.shared().map, map.shared().mutex, *parts.optimizer,
              *parts.matcher),
      closer_(parts.loop_closing, map.shared(), detector, *parts.optimizer, parts.run.seed, *parts.matcher),
      adjustment_(parts.loop_closing, map.shared(), *parts.optimizer) {
  if (moving_world.expects_masks()) mapper_.expect_masks();
  closer_.set_full_adjustment(&adjustment_);
  const Map& loaded = map.unshared();
  for (const KeyFrameId keyframe : loaded.keyframes_by_age())
    detector.add(keyframe, place_descriptors(loaded.keyframe(keyframe).frame, describes_images_));
  if ((parts.dense_map.enabled || parts.surface.enabled) && !parts.localise_only)
    scene_.emplace(parts.camera, parts.dense_map, parts.surface.enabled && parts.surface.classes);
  if (parts.surface.enabled && scene_) surface_.emplace(scene_->camera(), parts.surface);
  if (surface_ && parts.surface.carving_interval > 0.0)
    carving_.emplace(parts.surface.carving_interval, CarvingViews::per_keyframe * parts.dense_map.keyframes);
  // Without masks they would add surface of people, which carving has to remove again.
  if (surface_ && parts.surface.interval > 0.0 && moving_world.expects_masks())
    fused_frames_.emplace(scene_->sampler(), parts.surface.interval, parts.surface.frames_per_keyframe,
                          parts.dense_map.keyframes);
  if (surface_ && parts.surface.resting_time > 0.0) resting_.emplace(parts.surface.resting_time);
  const std::vector<std::string>& out = parts.dense_map.classes;
  for (const std::string& name : parts.segmenter->classes())
    left_out_.push_back(std::find(out.begin(), out.end(), name) != out.end());
}

void KeyframeFlow::start_threads() {
  const auto capacity = static_cast<std::size_t>(parts_.run.keyframe_queue);
  if (surface_)
    surface_fusion_.emplace("surface", 1, [this](SurfaceJob& job) {
      const auto max_moves = static_cast<std::size_t>(parts_.surface.moves_per_keyframe);
      in_background([&](StageTimes& times) { fuse(std::move(job.views), max_moves, times); });
    });
  full_adjustment_.emplace("full adjustment", 1,
                           [this](AdjustmentJob&) { in_background([&](StageTimes& times) { adjust_map(times); }); });
  loop_closing_.emplace("loop closing", capacity, [this](LoopJob& job) {
    bool closed = false;
    in_background([&](StageTimes& times) { closed = close_loops(job, times); });
    if (closed) full_adjustment_->queue().push_newest({});
  });
  mapping_.emplace("local mapping", capacity, [this](MappingJob& refined) {
    LoopJob job;
    in_background([&](StageTimes& times) { job = refine(refined, times); });
    loop_closing_->queue().push(std::move(job));
  });
}

void KeyframeFlow::rethrow_failures() {
  if (mapping_) mapping_->rethrow();
  if (loop_closing_) loop_closing_->rethrow();
  if (full_adjustment_) full_adjustment_->rethrow();
  if (surface_fusion_) surface_fusion_->rethrow();
  moving_world_.rethrow();
}

void KeyframeFlow::wait_for_room() {
  if (mapping_ && !parts_.run.paced()) mapping_->queue().wait_for_room();
}

void KeyframeFlow::hand_on_waiting_keyframes() {
  while (!waiting_.empty() && mapping_->queue().has_room()) {
    mapping_->queue().push(waiting_.front());
    waiting_.pop_front();
  }
}

bool KeyframeFlow::has_room_for_keyframe() {
  if (!mapping_ || (waiting_.empty() && mapping_->queue().has_room())) return true;
  ++keyframes_deferred_;
  return false;
}

KeyFrameId KeyframeFlow::begin_map(const LockedMap& map, const TwoViewMap& start, std::vector<MapPointId>& ids,
                                   StageTimes& times) {
  std::vector<std::pair<Eigen::Vector3d, std::uint32_t>> points;
  for (const TwoViewMap::Point& point : start.points) points.emplace_back(point.position, point.in_reference);
  return mapper_.begin(map, start.reference, points, ids, times);
}

KeyFrameId KeyframeFlow::insert(const LockedMap& map, const Frame& frame, bool waits_for_mask, std::uint32_t submap,
                                StageTimes& times) {
  return mapper_.insert(map, frame, waits_for_mask, times, submap);
}

double KeyframeFlow::take_masks(StageTimes& times) {
  double seconds = 0.0;
  for (;;) {
    const Stopwatch watch;
    const std::optional<ArrivedMask> arrived = moving_world_.take_mask(times);
    if (!arrived) return seconds;
    seconds += watch.seconds();
    if (!arrived->keyframe.valid()) continue;
    const KeptView* view = apply_mask(*arrived, seconds, times);
    show_view(view);
    update_surface(view, times);
    hand_to_mapping({arrived->keyframe, true, image_to_describe(arrived->frame)}, times);
  }
}

const KeptView* KeyframeFlow::apply_mask(const ArrivedMask& arrived, double& seconds, StageTimes& times) {
  const Stopwatch watch;
  const LockedMap map(map_, LockPriority::tracking);
  moving_world_.evaluate_keyframe(map, arrived, times);
  seconds += watch.seconds();
  const KeyFrame* keyframe = map->find_keyframe(arrived.keyframe);
  if (keyframe == nullptr) return nullptr;
  return keep_view(arrived.keyframe, arrived.frame, keyframe->frame.coarse, arrived.segmentation.labels, times);
}

void KeyframeFlow::request_mask(const SensorFrame& sensor_frame, const Frame& frame, bool is_needed,
                                const FrameResult& result, StageTimes& times) {
  const KeyFrameId keyframe = result.is_keyframe ? result.keyframe : KeyFrameId();
  const bool is_requested = moving_world_.request_mask(sensor_frame, keyframe, times, is_needed);
  keep_for_surface(sensor_frame, frame, result, times);
  if (!result.is_keyframe) return;
  if (is_requested) {
    // One camera makes all its points by triangulation, and would be lost before the mask arrives: a propagated mask
    // has to do until then.
    if (points_need_parallax_) hand_to_mapping({keyframe, false}, times);
    return;
  }
  const KeptView* view = keep_view(keyframe, sensor_frame, frame.coarse, {}, times);
  show_view(view);
  update_surface(view, times);
  hand_to_mapping({keyframe, true, image_to_describe(sensor_frame)}, times);
}

void KeyframeFlow::remove_map(const std::function<void(const LockedMap&)>& forget, StageTimes& times) {
  LoopJob job;
  mapper_.request_stop();
  {
    const LockedStructure structure(map_);  // an adjustment that runs relies on its keyframes
    const LockedMap map(map_, LockPriority::background);
    job.removed = map->keyframes_by_age();
    map->remove_all();
    if (scene_) scene_->forget_removed(map.map());
    if (carving_) carving_->forget_removed(map.map());
    if (fused_frames_) fused_frames_->forget_removed(map.map());
    if (resting_) resting_->clear();
    mapper_.forget_map();
    forget(map);
  }
  waiting_.clear();
  // Queued jobs check that their keyframe still exists; only the loop detector must be told.
  if (loop_closing_)
    loop_closing_->queue().push(std::move(job));
  else
    close_loops(job, times);
}

void KeyframeFlow::keep_submap(const LockedMap& map, std::uint32_t submap) {
  if (map->keyframes_outside(submap).empty()) return;
  map->keep_submap(submap);
  if (scene_) scene_->forget_removed(map.map());
  if (carving_) carving_->forget_removed(map.map());
  if (fused_frames_) fused_frames_->forget_removed(map.map());
}

void KeyframeFlow::hand_to_mapping(const MappingJob& job, StageTimes& times) {
  if (!mapping_) {
    if (close_loops(refine(job, times), times)) adjust_map(times);
    return;
  }
  if (!parts_.run.paced()) {
    mapping_->queue().push(job);
    return;
  }
  // Tracking needs the points of this keyframe adjusted soon; an older adjustment has done most of its good.
  mapper_.request_stop();
  if (waiting_.empty() && mapping_->queue().has_room()) {
    mapping_->queue().push(job);  // no other thread adds to the queue, so that this does not wait
    return;
  }
  if (!job.is_final) return;  // its mask brings it again
  waiting_.push_back(job);
  ++keyframes_deferred_;
}

KeyframeFlow::LoopJob KeyframeFlow::refine(const MappingJob& given, StageTimes& times) {
  LoopJob job{given.is_final ? given.keyframe : KeyFrameId(), {}, given.image};
  {
    const LockedStructure structure(map_);
    job.removed = mapper_.refine(given.keyframe, times);
  }
  if (!given.is_final || parts_.observers.empty() || !has_keyframe(given.keyframe)) return job;
  const ObservedMap observed = observed_map();
  for (const auto& observer : parts_.observers) observer->on_keyframe(given.keyframe, observed);
  return job;
}

void KeyframeFlow::describe_image(const LoopJob& job, StageTimes& times) {
  CoarseView coarse;
  {
    const LockedMap map(map_, LockPriority::background);
    const KeyFrame* keyframe = map->find_keyframe(job.keyframe);
    if (keyframe == nullptr) return;
    coarse.static_log_odds = keyframe->frame.coarse.static_log_odds;
    coarse.mask.labels = keyframe->frame.coarse.mask.labels;
  }
  const StageTimer timer(times, "loops: describe");
  const std::vector<std::uint8_t> left_out = PlaceWeights(detector_, moving_world_.classes()).minor_labels();
  DescriptorBlock descriptor = detector_.describe(job.image, moving_world_.moving_pixels(coarse, left_out));
  const LockedMap map(map_, LockPriority::background);
  if (KeyFrame* keyframe = map->find_keyframe(job.keyframe)) keyframe->frame.image_descriptor = std::move(descriptor);
}

bool KeyframeFlow::close_loops(const LoopJob& job, StageTimes& times) {
  std::optional<ClosedLoop> loop;
  if (job.keyframe.valid() && !job.image.empty()) describe_image(job, times);
  if (job.keyframe.valid()) loop = closer_.process(job.keyframe, times);
  for (const KeyFrameId id : job.removed) closer_.forget(id);
  if (!loop) {
    record_without_loop(job);
    return false;
  }
  ++corrections_;
  record_loop(*loop);
  return parts_.loop_closing.full_adjustment;
}

void KeyframeFlow::record_without_loop(const LoopJob& job) {
  const MutexLock lock(record_mutex_);
  loop_record_.counts = closer_.counts();
  const bool has_constraints = !loop_record_.loops.empty() || links_by_inertia_;
  if (job.keyframe.valid() && has_constraints && parts_.loop_closing.full_adjustment) ++keyframes_since_adjustment_;
}

void KeyframeFlow::record_loop(const ClosedLoop& loop) {
  LoopEvent event{.loop = loop};
  {
    const LockedMap map(map_, LockPriority::background);
    const auto stamp_of = [&](KeyFrameId id) {
      const KeyFrame* keyframe = map->find_keyframe(id);
      return keyframe == nullptr ? 0.0 : keyframe->frame.timestamp;
    };
    event.timestamp = stamp_of(loop.keyframe);
    event.candidate_timestamp = stamp_of(loop.candidate);
  }
  const ObservedMap observed = observed_map();
  for (const auto& observer : parts_.observers) observer->on_loop(loop.keyframe, loop.candidate, observed);
  const MutexLock lock(record_mutex_);
  loop_record_.counts = closer_.counts();
  loop_record_.loops.push_back(std::move(event));
  keyframes_since_adjustment_ = 0;
}

void KeyframeFlow::adjust_map(StageTimes& times) {
  const StageTimer timer(times, "loops: full adjustment");
  const FullAdjustmentSummary summary = adjustment_.run();
  ++corrections_;
  const MutexLock lock(record_mutex_);
  loop_record_.adjustments.push_back(summary);
}

const KeptView* KeyframeFlow::keep_view(KeyFrameId keyframe, const SensorFrame& frame, const CoarseView& coarse,
                                        const cv::Mat& labels, StageTimes& times) {
  if (!scene_) return nullptr;
  const StageTimer timer(times, "dense map: keep");
  if (!resting_ || coarse.static_log_odds.empty()) return &scene_->add(keyframe, frame, coarse, labels, left_out_);
  CoarseView released = coarse;
  released.static_log_odds = resting_->released(frame.index, coarse.static_log_odds);
  return &scene_->add(keyframe, frame, released, labels, left_out_);
}

void KeyframeFlow::keep_for_surface(const SensorFrame& sensor_frame, const Frame& frame, const FrameResult& result,
                                    StageTimes& times) {
  if (resting_) resting_->add(frame, result);
  if (result.is_keyframe) {
    if (carving_) carving_->keyframe_kept(frame.timestamp);
    if (fused_frames_) fused_frames_->keyframe_kept(frame.timestamp);
    return;
  }
  if (result.status != TrackingStatus::tracked || result.fallback != TrackingFallback::none) return;
  const bool is_fused = wants_frame(frame);
  if (!is_fused && !(carving_ && carving_->is_due(frame.timestamp))) return;
  Eigen::Isometry3d T_keyframe_world;
  {
    const LockedMap map(map_, LockPriority::tracking);
    if (!map->submap_of(result.keyframe)) return;
    T_keyframe_world = map->pose_of(result.keyframe);
  }
  const StageTimer timer(times, "dense map: keep");
  if (!is_fused) return carving_->add(frame, result.keyframe, T_keyframe_world);
  fused_frames_->add(sensor_frame, frame, result.keyframe, T_keyframe_world, left_out_);
  if (carving_) carving_->keyframe_kept(frame.timestamp);
}

bool KeyframeFlow::lock_surface() const {
  if (is_threaded()) return surface_mutex_.try_lock();
  surface_mutex_.lock();
  return true;
}

bool KeyframeFlow::wants_frame(const Frame& frame) {
  if (!fused_frames_ || !fused_frames_->is_due(frame.timestamp)) return false;
  // While a thread fuses, a later frame does as well.
  if (!lock_surface()) return false;
  const AdoptedLock lock(surface_mutex_);
  if (FusedFrames::is_worthwhile(frame, surface_->field(), left_out_)) return true;
  fused_frames_->leave_out(frame.timestamp);
  return false;
}

std::vector<KeptView> KeyframeFlow::views_of_surface() const {
  std::vector<KeptView> views = scene_->views();
  const auto add = [&](const std::vector<KeptView>& more) {
    const auto middle = static_cast<std::ptrdiff_t>(views.size());
    views.insert(views.end(), more.begin(), more.end());
    std::inplace_merge(views.begin(), views.begin() + middle, views.end(),
                       [](const KeptView& a, const KeptView& b) { return a.frame_index < b.frame_index; });
  };
  if (carving_) add(carving_->views());
  if (fused_frames_) add(fused_frames_->views());
  return views;
}

void KeyframeFlow::update_surface(const KeptView* view, StageTimes& times) {
  if (view == nullptr || !surface_) return;
  if (surface_fusion_)
    surface_fusion_->queue().push_newest({views_of_surface()});
  else
    fuse(views_of_surface(), static_cast<std::size_t>(parts_.surface.moves_per_keyframe), times);
}

void KeyframeFlow::fuse(std::vector<KeptView> views, std::size_t max_moves, StageTimes& times) {
  std::optional<StageTimer> timer;
  timer.emplace(times, "surface");
  std::vector<Eigen::Isometry3d> poses;
  const std::uint64_t corrections = corrections_;  // which the poses have
  {
    const LockedMap map(map_, LockPriority::background);
    // The map of a view may have been removed since.
    std::erase_if(views, [&](const KeptView& view) { return !map->submap_of(view.keyframe); });
    for (const KeptView& view : views) poses.push_back(view.T_world_view(map->pose_of(view.keyframe)));
  }
  {
    const MutexLock lock(surface_mutex_);
    const std::size_t waiting = surface_->update(views, poses, max_moves);
    fused_corrections_ = waiting == 0 ? std::optional(corrections) : std::nullopt;
    free_space_.reset();
  }
  timer.reset();
  show_surface();
}

void KeyframeFlow::show_surface() const {
  if (parts_.observers.empty()) return;
  // Only this thread changes the field; what finds its blocks is locked all the same, because it keeps the last place.
  const ObservedSurface observed{surface_->field().version(), [this](std::uint64_t since, int coarseness) {
                                   const MutexLock lock(surface_mutex_);
                                   return surface_->field().changes(since, coarseness);
                                 }};
  for (const auto& observer : parts_.observers) observer->on_surface(observed);
}

std::shared_ptr<const FreeSpace> KeyframeFlow::free_space() const {
  if (!surface_) return nullptr;
  const MutexLock lock(surface_mutex_);
  if (!free_space_)
    free_space_ = std::make_shared<const FreeSpace>(*surface_, surface_->field().mesh(), parts_.surface.cell);
  return free_space_;
}

std::optional<Eigen::Isometry3d> KeyframeFlow::align_with_surface(const Frame& frame,
                                                                  const Eigen::Isometry3d& predicted,
                                                                  StageTimes& times) const {
  if (!surface_) return std::nullopt;
  const StageTimer timer(times, "surface alignment");
  // While a thread fuses, other methods give the pose sooner.
  if (!lock_surface()) return std::nullopt;
  const AdoptedLock lock(surface_mutex_);
  // At the views' old poses it would hold the frame where the map was before.
  if (fused_corrections_ != corrections_.load()) return std::nullopt;
  const auto T_view_world = holdfast::align_with_surface(surface_->field(), frame.coarse, *frame.camera,
                                                         frame.coarse.T_view_world(predicted));
  if (!T_view_world) return std::nullopt;
  return frame.coarse.T_view_camera.inverse() * *T_view_world;
}

bool KeyframeFlow::with_surface(const std::function<void(const SurfaceMap&)>& look) const {
  if (!surface_) return false;
  const MutexLock lock(surface_mutex_);
  look(*surface_);
  return true;
}

void KeyframeFlow::finish_surface() {
  if (!surface_) return;
  std::vector<KeptView> views = views_of_surface();
  const std::size_t all = views.size();
  in_background([&](StageTimes& times) { fuse(std::move(views), all, times); });
}

void KeyframeFlow::show_view(const KeptView* view) {
  if (view == nullptr || parts_.observers.empty() || !parts_.dense_map.enabled) return;
  ObservedView observed{.keyframe = view->keyframe, .timestamp = view->timestamp};
  observed.points = [this, view](std::size_t max_count) { return scene_->surface(*view, max_count); };
  {
    const LockedMap map(map_, LockPriority::tracking);
    observed.T_world_camera = view->T_world_view(map->pose_of(view->keyframe));
  }
  for (const auto& observer : parts_.observers) observer->on_static_view(observed);
}

bool KeyframeFlow::has_keyframe(KeyFrameId keyframe) const {
  const LockedMap map(map_, LockPriority::background);
  return map->find_keyframe(keyframe) != nullptr;
}

void KeyframeFlow::finish() {
  // In the order in which work is handed on, so that nothing is left behind.
  if (moving_world_.expects_masks()) {
    moving_world_.finish();
    in_background([&](StageTimes& times) { take_masks(times); });
  }
  for (const MappingJob& job : std::exchange(waiting_, {})) mapping_->queue().push(job);
  if (mapping_) mapping_->finish();
  if (loop_closing_) loop_closing_->finish();
  if (full_adjustment_) full_adjustment_->finish();
  if (surface_fusion_) surface_fusion_->finish();
}

bool KeyframeFlow::adjust_at_end() {
  const bool has_map = !parts_.localise_only && !map_.unshared().keyframes().empty();
  const int rounds = has_map ? parts_.mapping.final_rounds : 0;
  {
    const MutexLock lock(record_mutex_);
    if (keyframes_since_adjustment_ == 0 && rounds == 0) {
      placed_keyframes_ = adjustment_.placed_keyframes();  // of the last loop
      return false;
    }
  }
  const auto adjust = [this] {
    if (interrupted_) return;
    in_background([this](StageTimes& times) { adjust_map(times); });
    const std::vector<double>& placed = adjustment_.placed_keyframes();
    placed_keyframes_.insert(placed_keyframes_.end(), placed.begin(), placed.end());
  };
  adjust();
  for (int round = 0; round < rounds && !interrupted_; ++round) {
    in_background([this](StageTimes& times) {
      const LockedStructure structure(map_);
      mapper_.fuse_whole_map(interrupted_, times);
    });
    adjust();
  }
  return true;
}

void KeyframeFlow::request_stop() {
  interrupted_ = true;
  mapper_.request_stop();
  adjustment_.cancel();
}

std::vector<StageTimes> KeyframeFlow::take_background_times() {
  const MutexLock lock(record_mutex_);
  return std::exchange(background_times_, {});
}

LoopRecord KeyframeFlow::loop_record() const {
  const MutexLock lock(record_mutex_);
  return loop_record_;
}

std::vector<WorkerCounts> KeyframeFlow::worker_counts() const {
  std::vector<WorkerCounts> counts;
  if (mapping_) counts.push_back(mapping_->counts());
  if (loop_closing_) counts.push_back(loop_closing_->counts());
  if (full_adjustment_) counts.push_back(full_adjustment_->counts());
  if (surface_fusion_) counts.push_back(surface_fusion_->counts());
  if (const auto segmentation = moving_world_.worker_counts()) counts.push_back(*segmentation);
  return counts;
}

MapSnapshot KeyframeFlow::snapshot() const {
  const LockedMap map(map_, LockPriority::background);
  return make_snapshot(map.map());
}

}  // namespace holdfast
