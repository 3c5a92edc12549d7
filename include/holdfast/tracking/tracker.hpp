// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/interfaces/loop_detector.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/segmentation/mask_propagator.hpp"
#include "holdfast/tracking/depth_agreement.hpp"
#include "holdfast/tracking/filter_chain.hpp"
#include "holdfast/tracking/frame_builder.hpp"
#include "holdfast/tracking/local_map.hpp"
#include "holdfast/tracking/projection_search.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

/// Finds the pose of every frame against the map (Mur-Artal and Tardos 2017, section III): prediction with constant
/// velocity, or the reference keyframe when that fails, then the local map, then a keyframe decision. When lost, the
/// last keyframes are tried, then the places that the loop detector recognises. Changes the map only by counting how
/// often points are found. One thread.
class Tracker {
 public:
  /// Extractor, optimizer, filters, detector and map must outlive the tracker. With keyframes in the map it begins lost
  /// and has to find its place among them first.
  Tracker(const TrackingSettings& settings, const Camera& camera, FeatureExtractor& extractor, Optimizer& optimizer,
          FilterChain& filters, const LoopDetector& detector, Map& map, std::uint64_t seed);

  /// From now on no frame becomes a keyframe.
  void localise_only() { localises_only_ = true; }

  /// First half of a frame: finds its features. Does not look at the map.
  void begin(const SensorFrame& sensor_frame, FrameResult& result);
  /// Second half: finds its pose; the caller holds the lock of the map. When the result says is_keyframe, hand frame()
  /// to local mapping and call keyframe_added() before the lock is given back.
  void locate(const SensorFrame& sensor_frame, FrameResult& result);

  /// The frame last tracked, as features, matches and pose.
  const Frame& frame() const { return current_; }
  /// The keyframe that the tracked frame became: its matches and its pose, as local mapping left them, are taken over.
  void keyframe_added(KeyFrameId keyframe);

  /// From now on masks are carried from frame to frame. They come from `segmenter`, which must outlive the tracker and
  /// is asked for the names of its classes only. `memory`: see MaskPropagator.
  void expect_masks(const Segmenter& segmenter, double memory);
  /// The frame last tracked is going to be segmented.
  void await_mask();
  /// The segmentation of an awaited frame has come.
  void mask_came(std::uint64_t frame_index, const Segmentation& segmentation);
  /// Judges a keyframe by its own segmentation; the caller holds the lock of the map.
  void judge_keyframe(const SensorFrame& sensor_frame, const Segmentation& segmentation, KeyFrameId keyframe);
  /// While keyframes wait for their masks, only a frame that is about to lose its place may become one.
  void hold_keyframes(bool hold) { holds_keyframes_ = hold; }

  /// Every tracked frame's pose as the map knows it now; the caller holds the lock of the map. Frames follow the
  /// keyframes that they were tracked against.
  Trajectory trajectory() const;

 private:
  enum class State { waiting, tracking, lost };

  bool start_map(FrameResult& result);
  bool predict_with_velocity(FrameResult& result);
  bool predict_with_keyframe(KeyFrameId keyframe, FrameResult& result);
  bool coast(FrameResult& result);
  bool recover(FrameResult& result);
  bool relocalise(FrameResult& result);
  bool fits_surroundings(FrameResult& result);
  bool could_have_come_here() const;
  bool track_local_map(const SensorFrame& sensor_frame, FrameResult& result);
  bool contradicts_depth(const FrameResult& result);
  bool needs_keyframe(const FrameResult& result) const;
  Eigen::Isometry3d predicted_step() const;
  FilterContext filter_context(const SensorFrame& sensor_frame, const Eigen::Isometry3d* T_camera_world) const;
  void judge(FilterChain::Stage stage, const SensorFrame& sensor_frame, FrameResult& result);
  void judge_with_pose(const SensorFrame& sensor_frame, FrameResult& result);
  int judge_after_matching(const SensorFrame& sensor_frame, int inliers, FrameResult& result);
  void state_problem();
  int adjust_pose();
  int match_local_map(float window);
  void drop_outliers();
  int match_previous(float radius_factor);
  void match_descriptors(const Frame& keyframe_frame);
  void remember(FrameResult& result);

  /// A tracked frame, fixed to its reference keyframe.
  struct Record {
    double timestamp;
    KeyFrameId reference;
    Eigen::Isometry3d T_camera_reference;
  };

  TrackingSettings settings_;
  FrameBuilder builder_;
  Optimizer& optimizer_;
  FilterChain& filters_;
  const LoopDetector& detector_;
  Map& map_;
  Random random_;

  State state_;
  bool localises_only_ = false;
  bool holds_keyframes_ = false;
  std::optional<MaskPropagator> propagator_;
  const std::vector<std::string>* classes_ = nullptr;
  std::vector<std::string> movable_;
  Frame current_, previous_;
  bool has_previous_ = false;  // previous_ has a pose
  Eigen::Isometry3d T_previous_reference_ = Eigen::Isometry3d::Identity();
  bool has_velocity_ = false;
  Eigen::Isometry3d velocity_ = Eigen::Isometry3d::Identity();  // T_current_previous of the last step
  double velocity_interval_ = 0.0;                              // [s]
  double coasts_until_ = 0.0;  // while lost: how long the last velocity is a guess worth trying [s]
  KeyFrameId reference_keyframe_;
  KeyFrameId last_keyframe_;
  double last_keyframe_time_ = 0.0;
  std::vector<Record> records_;

  DepthAgreement depth_agreement_;
  LocalMap local_map_;
  ProjectionSearch search_;
  SearchWindows windows_;
  PoseProblem problem_;
  double pose_deviation_ = 0.0;  // of the position that was last adjusted [m]
  std::vector<std::uint32_t> problem_features_;
};

}  // namespace holdfast
