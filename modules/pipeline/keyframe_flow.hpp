// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "guarded_map.hpp"
#include "holdfast/core/worker.hpp"
#include "holdfast/dense_map/static_scene.hpp"
#include "holdfast/loop_closing/full_adjustment.hpp"
#include "holdfast/loop_closing/loop_closer.hpp"
#include "holdfast/mapping/local_mapper.hpp"
#include "holdfast/moving_world/moving_world.hpp"
#include "holdfast/pipeline/pipeline.hpp"
#include "holdfast/surface/carving_views.hpp"
#include "holdfast/surface/free_space.hpp"
#include "holdfast/surface/fused_frames.hpp"
#include "holdfast/surface/resting_cells.hpp"
#include "holdfast/surface/surface_map.hpp"
#include "holdfast/tracking/mono_initialiser.hpp"

namespace holdfast {

/// The stations of a keyframe behind tracking: its mask, the dense map, local mapping, loop closing, and full
/// adjustment after a loop. In sequential mode the caller's thread does all of it within the call; in threaded mode
/// local mapping, loop closing and full adjustment have a thread each, and keyframes wait for room in its queue.
///
/// The thread that calls Pipeline::feed() calls all public functions, request_stop() and loop_record() excepted, which
/// any thread may call. It holds no lock, except for the functions that take a LockedMap.
class KeyframeFlow {
 public:
  /// All must outlive the object.
  KeyframeFlow(PipelineParts& parts, GuardedMap& map, MovingWorld& moving_world, SharedLoopDetector& detector);

  /// Corrects the keyframes by the calibration of a stereo pair; before the first keyframe.
  void calibrate_pair(StereoCalibration& calibration) { mapper_.calibrate_pair(calibration); }
  /// Has full adjustments use inertial measurements; before the first keyframe.
  void use_inertia(InertialHistory& history) {
    links_by_inertia_ = true;
    adjustment_.use_inertia(history);
    closer_.use_inertia();
  }
  void start_threads();
  bool is_threaded() const { return mapping_.has_value(); }
  /// Throws what a thread threw, the segmenter's included.
  void rethrow_failures();
  /// Waits until the queue of keyframes has room; does nothing with pacing.
  void wait_for_room();
  /// Hands keyframes on that had to wait for room.
  void hand_on_waiting_keyframes();

  /// Whether there is room for another keyframe; counts it as deferred otherwise.
  bool has_room_for_keyframe();
  /// Inserts the first of the two keyframes with which the map of one camera begins; the ids of its points are written
  /// to `points`, in their order.
  KeyFrameId begin_map(const LockedMap& map, const TwoViewMap& start, std::vector<MapPointId>& points,
                       StageTimes& times);
  /// Inserts a tracked frame as a keyframe; with `waits_for_mask` it gets its points when its mask arrives.
  KeyFrameId insert(const LockedMap& map, const Frame& frame, bool waits_for_mask, std::uint32_t submap,
                    StageTimes& times);
  /// Hands a keyframe to local mapping that needs no mask.
  void refine_without_mask(KeyFrameId keyframe, StageTimes& times) { hand_to_mapping({keyframe}, times); }

  /// Applies the masks that have arrived and hands the keyframes that waited for them to mapping. Returns the seconds
  /// that applying them took.
  double take_masks(StageTimes& times);
  /// Requests the mask of the frame last tracked, if it should have one. A keyframe that cannot be segmented now goes
  /// on without a mask. `is_needed`: see MapRequest::wants_mask.
  void request_mask(const SensorFrame& sensor_frame, const Frame& frame, bool is_needed, const FrameResult& result,
                    StageTimes& times);

  /// Removes the whole map, which began wrong, from all stations; `forget` is called meanwhile.
  void remove_map(const std::function<void(const LockedMap&)>& forget, StageTimes& times);
  /// Removes the submaps that nothing joined with this one; the threads have ended.
  void keep_submap(const LockedMap& map, std::uint32_t submap);

  /// Waits until every station has done what waits for it, and ends the threads.
  void finish();
  /// Runs one more full adjustment if keyframes were added since the last loop, which constrain it further. With
  /// inertial measurements or MappingSettings::final_rounds it runs without a loop as well; these rounds follow.
  /// The threads have ended. Returns whether there was something to do.
  bool adjust_at_end();
  /// See FullAdjustment::placed_keyframes(): of all adjustments of adjust_at_end(), some more than once, or else of the
  /// last one before.
  const std::vector<double>& placed_keyframes() const { return placed_keyframes_; }
  /// Fuses every view at its final pose; the threads have ended.
  void finish_surface();
  /// Makes long adjustments end after their current iteration.
  void request_stop();

  /// Does work that fills stage times, and keeps them for take_background_times().
  template <class Work>
  void in_background(const Work& work) {
    StageTimes times;
    work(times);
    const MutexLock lock(record_mutex_);
    background_times_.push_back(std::move(times));
  }
  std::vector<StageTimes> take_background_times();
  LoopRecord loop_record() const;
  std::uint64_t keyframes_deferred() const { return keyframes_deferred_; }
  std::vector<WorkerCounts> worker_counts() const;
  const MappingCounts& mapping_counts() const { return mapper_.counts(); }
  const StaticScene* static_scene() const { return parts_.dense_map.enabled && scene_ ? &*scene_ : nullptr; }
  const SurfaceMap* surface() const { return surface_ ? &*surface_ : nullptr; }
  /// See Pipeline::free_space().
  std::shared_ptr<const FreeSpace> free_space() const HOLDFAST_EXCLUDES(surface_mutex_);
  /// T_camera_world of a frame by the surface as fused so far, from its predicted value; empty if its depth does not
  /// determine it, while views wait to be fused at their corrected poses, and in threaded mode while another thread
  /// uses the surface.
  std::optional<Eigen::Isometry3d> align_with_surface(const Frame& frame, const Eigen::Isometry3d& predicted,
                                                      StageTimes& times) const HOLDFAST_EXCLUDES(surface_mutex_);
  /// See Pipeline::with_surface().
  bool with_surface(const std::function<void(const SurfaceMap&)>& look) const HOLDFAST_EXCLUDES(surface_mutex_);
  /// A copy of the map, from any thread.
  MapSnapshot snapshot() const;

 private:
  /// A keyframe for local mapping. Without its mask yet it is not final: it comes again with the mask, and only then to
  /// loop closing.
  struct MappingJob {
    KeyFrameId keyframe;
    bool is_final = true;
    cv::Mat image = {};  // see image_to_describe()
  };
  /// A keyframe for loop closing, and the keyframes that local mapping removed.
  struct LoopJob {
    KeyFrameId keyframe;
    std::vector<KeyFrameId> removed;
    cv::Mat image;
  };
  /// All views that are kept, for the surface: a newer job replaces one that waits.
  struct SurfaceJob {
    std::vector<KeptView> views;
  };
  /// The whole map, for full adjustment.
  struct AdjustmentJob {};

  /// With pacing it never waits: a keyframe that finds no room waits until a later frame.
  void hand_to_mapping(const MappingJob& job, StageTimes& times);
  LoopJob refine(const MappingJob& job, StageTimes& times);
  /// Closes a loop from the keyframe, if there is one; whether the whole map should be adjusted then.
  bool close_loops(const LoopJob& job, StageTimes& times);
  void record_without_loop(const LoopJob& job);
  void record_loop(const ClosedLoop& loop);
  /// Has the loop detector describe the image of a keyframe without what moves in it.
  void describe_image(const LoopJob& job, StageTimes& times);
  void adjust_map(StageTimes& times);
  /// The colour image of a keyframe if the loop detector will describe it; otherwise none, so that none is kept.
  cv::Mat image_to_describe(const SensorFrame& frame) const { return describes_images_ ? frame.colour : cv::Mat(); }
  /// Evaluates a keyframe again by its own mask, which adds to `seconds`, and keeps its view for the dense map.
  const KeptView* apply_mask(const ArrivedMask& arrived, double& seconds, StageTimes& times);
  /// Keeps the view of a keyframe for the dense map, with the final evidence of motion in it; `labels` may be empty.
  /// nullptr without a dense map; valid until the next call.
  const KeptView* keep_view(KeyFrameId keyframe, const SensorFrame& frame, const CoarseView& coarse,
                            const cv::Mat& labels, StageTimes& times);
  /// Keeps a frame between keyframes if the surface is to be fused from it, or carved by its coarse depth.
  void keep_for_surface(const SensorFrame& sensor_frame, const Frame& frame, const FrameResult& result,
                        StageTimes& times) HOLDFAST_EXCLUDES(map_);
  /// Whether a frame between keyframes is to be fused into the surface.
  bool wants_frame(const Frame& frame) HOLDFAST_EXCLUDES(surface_mutex_);
  /// Locks the surface; with threads only if none of them fuses now. Returns whether it is locked.
  bool lock_surface() const HOLDFAST_TRY_ACQUIRE(true, surface_mutex_);
  /// What the surface is made of: kept views and those that only carve, by increasing frame index.
  std::vector<KeptView> views_of_surface() const;
  /// Adds a kept view to the surface, if there are both.
  void update_surface(const KeptView* view, StageTimes& times);
  void fuse(std::vector<KeptView> views, std::size_t max_moves, StageTimes& times)
      HOLDFAST_EXCLUDES(map_, surface_mutex_);
  /// Tells the observers that the surface has changed.
  void show_surface() const HOLDFAST_EXCLUDES(surface_mutex_);
  /// Tells the observers of a kept view, if there is one.
  void show_view(const KeptView* view) HOLDFAST_EXCLUDES(map_);
  bool has_keyframe(KeyFrameId keyframe) const HOLDFAST_EXCLUDES(map_);
  ObservedMap observed_map() const {
    return ObservedMap([this] { return snapshot(); });
  }

  PipelineParts& parts_;
  GuardedMap& map_;
  MovingWorld& moving_world_;
  SharedLoopDetector& detector_;
  const bool describes_images_;      // the detector, instead of using descriptors of features
  const bool points_need_parallax_;  // all points are made by triangulation
  bool links_by_inertia_ = false;    // in full adjustments
  LocalMapper mapper_;
  LoopCloser closer_;
  FullAdjustment adjustment_;
  std::optional<StaticScene> scene_;
  std::optional<CarvingViews> carving_;
  std::optional<FusedFrames> fused_frames_;
  std::optional<RestingCells> resting_;
  mutable Mutex surface_mutex_;
  std::optional<SurfaceMap> surface_;           // changes with the mutex held
  std::atomic<std::uint64_t> corrections_ = 0;  // of the map, by loops and full adjustments
  /// Those that every view of the surface has; empty while views wait to be moved.
  std::optional<std::uint64_t> fused_corrections_ HOLDFAST_GUARDED_BY(surface_mutex_);
  mutable std::shared_ptr<const FreeSpace> free_space_ HOLDFAST_GUARDED_BY(surface_mutex_);  // nullptr if outdated
  std::vector<bool> left_out_;      // of the static scene, by label
  std::deque<MappingJob> waiting_;  // they have their masks, but mapping had no room
  std::uint64_t keyframes_deferred_ = 0;
  std::vector<double> placed_keyframes_;  // time stamps [s]
  std::atomic<bool> interrupted_ = false;

  mutable Mutex record_mutex_;
  std::vector<StageTimes> background_times_ HOLDFAST_GUARDED_BY(record_mutex_);
  LoopRecord loop_record_ HOLDFAST_GUARDED_BY(record_mutex_);
  /// Of the whole map; without inertial measurements none before the first loop.
  int keyframes_since_adjustment_ HOLDFAST_GUARDED_BY(record_mutex_) = 0;

  // Threads last: they use everything above, and each hands its work on to the one before it here.
  std::optional<Worker<SurfaceJob>> surface_fusion_;
  std::optional<Worker<AdjustmentJob>> full_adjustment_;
  std::optional<Worker<LoopJob>> loop_closing_;
  std::optional<Worker<MappingJob>> mapping_;
};

}  // namespace holdfast
