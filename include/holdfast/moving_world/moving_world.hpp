// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/map_access.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/core/worker.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/moving_world/depth_agreement.hpp"
#include "holdfast/moving_world/filter_chain.hpp"
#include "holdfast/moving_world/mask_counts.hpp"
#include "holdfast/moving_world/mask_propagator.hpp"
#include "holdfast/moving_world/segmentation_queue.hpp"
#include "holdfast/moving_world/segmentation_settings.hpp"

namespace holdfast {

/// The parts of a MovingWorld. Without filters every feature counts as static; without a segmenter there are no masks.
struct MovingWorldParts {
  Camera camera;
  FilterChain filters = FilterChain();
  Segmenter* segmenter = nullptr;  ///< nullptr = none; must outlive the MovingWorld
  SegmentationSettings segmentation = {};
  bool threaded = false;  ///< the segmenter runs in a separate thread
  bool has_depth = true;  ///< false in monocular mode, without checks by dense depth
};

/// The frame that is being tracked, as filters see it.
struct TrackedView {
  const SensorFrame& sensor_frame;
  const Frame* previous;  ///< the previous frame with its pose; nullptr when it has none
  Frame& frame;
  std::uint32_t submap = 0;                            ///< submap in which the frame is tracked
  const PredictedPose* inertial_prediction = nullptr;  ///< by inertial measurements; nullptr when there is none
};

/// A pose of the current frame from the motion model.
struct PosePrediction {
  Eigen::Isometry3d T_camera_world;
  Eigen::Isometry3d T_world_previous;  ///< pose of the previous frame
};

/// A mask that arrived from the segmenter and was applied to the current frame.
struct ArrivedMask {
  SensorFrame frame;
  KeyFrameId keyframe;        ///< the keyframe made of the frame; invalid when there is none
  Segmentation segmentation;  ///< empty when the segmenter had no result
  CellMask mask;              ///< the segmentation on the cells of the frame's coarse view
};

/// Facade for dynamic scenes: static probability of features and map points, and checks of poses against dense depth.
/// It owns the masks (segmentation queue, propagation to every frame) and the filters with their evidence, and hides
/// them from tracker and pipeline. One thread, except the segmenter's own.
///
/// Functions marked with * read or write the map: Tracker calls them within the MapAccess that it was given.
class MovingWorld {
 public:
  /// The map must outlive the MovingWorld.
  MovingWorld(MovingWorldParts parts, Map& map);
  MovingWorld(const MovingWorld&) = delete;
  MovingWorld& operator=(const MovingWorld&) = delete;

  // Called by the tracker, in this order for each frame.

  /// Propagates the mask to a frame that has its coarse depth but no features yet; `T_frame_previous` is the predicted
  /// motion. Returns the raw pixels (8UC1, not 0) in which no features should be extracted; empty = extract everywhere.
  /// Adds the stage "masks".
  cv::Mat begin_frame(const cv::Mat& grey, const Eigen::Isometry3d& T_frame_previous, Frame& frame, StageTimes& times);
  /// * Runs the filters of a stage; false when there are none. The stage before_matching begins the evidence of the
  /// frame. Adds the stage "filters".
  bool evaluate(FilterStage stage, const TrackedView& view, StageTimes& times);
  bool has(FilterStage stage) const { return filters_.has(stage); }
  /// * Sets the weights of the frame's features from the evidence so far.
  void weight_features(Frame& frame) { filters_.weight_features(map_, frame); }
  /// True if features are weighted by filters. Inliers that are more likely moving than static are then not counted.
  bool weights_features() const { return !filters_.empty(); }
  /// * Replaces the pose by the prediction of the motion model if that agrees clearly better with the depth of
  /// keyframes around `reference`, because matches on moving objects have then biased the pose. Then estimates
  /// coarse.T_view_camera. Adds the stage "filters".
  void check_pose(const PosePrediction& prediction, KeyFrameId reference, Frame& frame, StageTimes& times);
  /// * Whether a pose with this number of inliers contradicts the depth of the keyframes around `reference`. The limits
  /// are stricter after a loss, see EvidenceSettings.
  bool contradicts_depth(const Frame& frame, int inliers, bool was_lost, KeyFrameId reference);
  /// * True if keyframes around `reference` predict depth for this view but almost none of it is observed: something
  /// large occludes the static scene, and the inliers may lie on it. False if the keyframes predict no depth.
  bool is_view_filled(const Frame& frame, KeyFrameId reference);
  /// Fallback for the current frame: gives features on masks a non-zero weight. False if no feature changes.
  /// contradicts_depth() then requires agreement with dense depth for any number of inliers.
  bool discount_priors() { return has_depth_ && filters_.discount_priors(); }
  /// * Dense depth alignment: T_camera_world by ICP with keyframes around `reference`, from a predicted pose; nothing
  /// if its depth contradicts them. Adds the stage "depth alignment".
  std::optional<Eigen::Isometry3d> align_depth(const Frame& frame, const Eigen::Isometry3d& predicted,
                                               KeyFrameId reference, StageTimes& times);
  /// * Adds the frame's measurements to its map points.
  void accumulate(const Frame& frame) { filters_.accumulate(frame, map_); }
  /// Ends a frame: passes its pose, if it has one, and the moving cells to the mask propagation.
  void end_frame(const Frame& frame, bool has_pose);

  /// Objects that filters track in this frame.
  const std::vector<MovingObject>& objects() const { return filters_.evidence().objects(); }
  /// Whether a mask has arrived.
  bool has_mask() const { return propagator_ && !propagator_->mask().empty(); }
  /// Age of the propagated mask [s]; 0 without a mask.
  double mask_age() const { return propagator_ ? propagator_->mask().age : 0.0; }
  /// True if so many keyframes wait for their masks that another one should be created only to avoid a loss of
  /// tracking.
  bool holds_keyframes() const { return queue_ && queue_->is_full(); }

  /// Class names of the segmenter by label; empty without one. Any thread.
  const std::vector<std::string>& classes() const { return classes_; }
  /// Raw pixels (8UC1, not 0) of the cells of a view that are more likely moving than static, or whose label is left
  /// out: `left_out` has an entry that is not 0 for each of 256 labels to leave out, or is empty. Empty if there are
  /// none. Any thread.
  cv::Mat moving_pixels(const CoarseView& view, std::span<const std::uint8_t> left_out = {}) const;

  /// True if more than half of the cells show classes that can move, or are more likely moving than static. Any thread.
  bool hides_most(const CoarseView& view) const;

  // Called by the pipeline.

  bool expects_masks() const { return queue_.has_value(); }
  /// Begins a frame: masks that are available at this frame can be taken.
  void next_frame(double timestamp);
  /// The next mask that has arrived, if any. It is already applied to the current frame. Adds the stage "masks".
  std::optional<ArrivedMask> take_mask(StageTimes& times);
  /// Evaluates the features of the keyframe again by its own mask; has no effect if the keyframe was removed or the
  /// mask is empty. Adds the stage "masks".
  void evaluate_keyframe(const MapAccess& map, const ArrivedMask& arrived, StageTimes& times);
  /// Requests the mask of the last tracked frame. `keyframe` is the keyframe made of it, invalid if there is none;
  /// `is_needed` requests the mask of a frame that is no keyframe. False if the frame is not selected for segmentation
  /// or the queue is full. In sequential mode this adds the stage "segmentation".
  bool request_mask(const SensorFrame& sensor_frame, KeyFrameId keyframe, StageTimes& times, bool is_needed = false);
  /// Waits until every requested mask is available. Rethrows exceptions of the segmenter.
  void finish();
  /// Rethrows exceptions of the segmenter's thread.
  void rethrow();

  const MaskCounts& mask_counts() const { return mask_counts_; }
  /// Latency of each mask: from the time stamp of its frame to that of the first frame to which it was applied, or of
  /// the last frame of the run [s].
  const std::vector<double>& mask_latencies() const { return mask_latencies_; }
  /// Stage times of the segmentation thread since the last call.
  std::vector<StageTimes> take_times();
  std::optional<WorkerCounts> worker_counts() const;

 private:
  FilterContext context(const SensorFrame& sensor_frame, const Frame& frame) const;
  void count_mask(const CellMask& mask);
  bool covers_upper_edge(const CellMask& mask) const;

  Map& map_;
  FilterChain filters_;
  bool has_depth_;
  DepthAgreement depth_agreement_;
  CoarseSampler sampler_;
  std::vector<std::string> classes_, movable_;
  std::array<bool, 256> is_movable_{};  // by label, of the filters
  MaskCounts mask_counts_;
  std::optional<MaskPropagator> propagator_;
  std::uint64_t next_frame_number_ = 0;
  double timestamp_ = 0.0;  // of the current frame [s]
  std::vector<double> mask_latencies_;
  std::optional<SegmentationQueue> queue_;  // last: its thread ends before the others go
};

}  // namespace holdfast
