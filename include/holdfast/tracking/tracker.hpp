// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/interfaces/loop_detector.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/moving_world/moving_world.hpp"
#include "holdfast/tracking/backward_tracker.hpp"
#include "holdfast/tracking/feature_flow.hpp"
#include "holdfast/tracking/frame_builder.hpp"
#include "holdfast/tracking/frame_history.hpp"
#include "holdfast/tracking/frame_matcher.hpp"
#include "holdfast/tracking/keyframe_policy.hpp"
#include "holdfast/tracking/loss_record.hpp"
#include "holdfast/tracking/mono_initialiser.hpp"
#include "holdfast/tracking/pose_estimator.hpp"
#include "holdfast/tracking/relocaliser.hpp"
#include "holdfast/tracking/rolling_shutter.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

/// What a Tracker works with; all of it but the camera must outlive the Tracker.
struct TrackerParts {
  const Camera& camera;
  FeatureExtractor& features;
  Optimizer& optimizer;
  LoopDetector& detector;
  MovingWorld& moving_world;
  Map& map;
  std::uint64_t seed = 1;                  ///< of the random samples of relocalisation
  std::optional<StereoParts> stereo = {};  ///< depth comes from a right image
  bool has_depth = true;                   ///< false for one camera; stereo pairs have depth
  const FeatureMatcher& matcher = nearest_matcher();
};

/// Where am I: estimates the pose of every frame against the map (Mur-Artal and Tardos 2017, section III). The motion
/// model, or the reference keyframe when that fails, gives a first pose; the local map refines it; KeyframePolicy
/// decides on a keyframe. MovingWorld decides what to trust in each step. A frame that static features do not determine
/// is tracked relative to the previous one, by masked features as well, or by dense depth (TrackingFallback). A lost
/// camera is relocalised (Relocaliser); one that is lost right after the start begins the map anew, beside what there
/// is of it. One camera gives such a map up instead, and a map that does not grow after its start too.
///
/// The tracker writes to the map only what it observes of points: how often they are visible and found, and their
/// static log-odds (through MovingWorld). One thread.
class Tracker {
 public:
  /// With keyframes in the map the tracker begins lost and has to relocalise first.
  Tracker(const TrackingSettings& settings, const TrackerParts& parts);
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;

  /// From now on no frame becomes a keyframe.
  void localise_only() { localises_only_ = true; }

  /// Throws InputError for images that begin() would refuse.
  void check_images(const SensorFrame& sensor_frame) const { builder_.check_images(sensor_frame); }
  /// First half of a frame: propagates the mask and extracts features. It does not read the map.
  void begin(const SensorFrame& sensor_frame, FrameResult& result);
  /// Second half: estimates the pose; the caller holds the lock of the map. When the result says is_keyframe, hand
  /// frame() to local mapping and call keyframe_added() before the next frame.
  void locate(const SensorFrame& sensor_frame, FrameResult& result);

  /// Whether the frame just located begins a new piece of the map, because the camera was lost.
  bool begins_piece() const { return begins_piece_; }
  /// Whether the camera was lost a moment ago: what fills its view may be what it was lost by.
  bool was_just_found() const;
  /// Whether a mask of the frame just located is needed, although it has no pose or an unconfirmed one: what is known
  /// to be static finds the camera again, or begins a new piece.
  bool needs_mask() const;
  /// The piece of the map that the camera is tracked in; the caller holds the lock of the map.
  std::uint32_t piece() const { return map_.piece_of(reference_keyframe_).value_or(0); }

  /// The views that begin the map of one camera, when the frame just located did so: hand the reference to local
  /// mapping, call map_begun(), and go on with frame() as with any keyframe. Otherwise nullptr.
  const TwoViewStart* two_view_start() const { return begins_with_two_views_ ? &mono_->start() : nullptr; }
  /// The reference became `reference`, and the points of the start, in their order, became `points`; the caller holds
  /// the lock of the map.
  void map_begun(KeyFrameId reference, const std::vector<MapPointId>& points);

  /// Whether the frame just located showed that the map of one camera began wrong: remove all of it, call forget_map(),
  /// and the next frames begin another one.
  bool gave_map_up() const { return gave_map_up_; }
  /// As if no frame had been tracked. The map is empty; the caller holds its lock.
  void forget_map();

  /// Whether the mask that arrived first shows that the map began on what moves: remove all of it, call forget_map(),
  /// and the next frame begins another one, from which those before it are tracked backwards. The caller holds the lock
  /// of the map.
  bool is_start_refuted();
  /// No frame follows: poses after a loss that nothing has confirmed are withdrawn, and frames that wait to be tracked
  /// backwards are. The caller holds the lock of the map.
  void finish(StageTimes& times);
  /// What became of frames around losses until now; the caller holds the lock of the map.
  LossRecord loss_record() const;

  /// The frame last tracked, with features, matches and pose.
  const Frame& frame() const { return current_; }
  /// Takes over the matches and the pose of the keyframe that the tracked frame became, as local mapping left them; the
  /// caller holds the lock of the map.
  void keyframe_added(KeyFrameId keyframe);

  /// What is known of the rolling shutter by now.
  const RollingShutter& rolling_shutter() const { return shutter_; }

  /// The piece of the map with most of the tracked frames; the caller holds the lock of the map.
  std::uint32_t main_piece() const { return history_.main_piece(map_); }
  /// Every tracked frame's pose by the map as it is now; the caller holds the lock of the map. Frames follow the
  /// keyframes that they were tracked against.
  Trajectory trajectory() const { return history_.trajectory(map_); }

 private:
  enum class State { waiting, tracking, lost };

  /// The motion since the previous frame, T_current_previous = step; nothing after so long that it says little about
  /// the velocity now.
  std::optional<FrameMotion> motion_by(const Eigen::Isometry3d& step) const;
  /// Places the features of the current frame again, for a camera that moved so since the previous one.
  void place_features(const SensorFrame& sensor_frame, const Eigen::Isometry3d& step, StageTimes& times);
  /// Whether the camera was lost so soon after the map began that waiting for a known view is not worth it: with a
  /// first keyframe on people, or a wrong first mask, next to nothing of the map may be left.
  bool was_lost_at_start() const;
  /// Whether the camera has been lost for so long that it should go on in a new piece of the map.
  bool should_begin_piece();
  /// T_camera_world of a camera that goes on from the previous frame with its last velocity.
  Eigen::Isometry3d predicted_pose() const;
  /// T_camera_world where the motion model puts a lost camera at a time [s]; after the coasting time, where it was last
  /// seen.
  Eigen::Isometry3d coasting_pose(double timestamp) const;
  /// Makes the current frame the first keyframe of what comes, at the given pose, if enough of its features have depth.
  bool start_map(const Eigen::Isometry3d& T_camera_world, FrameResult& result);
  /// Begins the map with this frame, without what a mask shows to be movable if one is there.
  void start_with_depth(const SensorFrame& sensor_frame, FrameResult& result);
  /// Weights the features of the current frame; whether enough static ones have depth for a map to begin with them.
  bool can_begin_among_people();
  /// The same for one camera, whose map begins with two views.
  void start_with_two_views(const SensorFrame& sensor_frame, FrameResult& result);
  /// Whether the map of one camera began with people, or with points that do not determine its shape: few new points
  /// fit it then. Judged once, from what the frames of a short time after the start found in it.
  bool is_weak_start(const FrameResult& result);
  void begin_map(FrameResult& result);
  bool find_pose(TrackedView& view, FrameResult& result);
  /// Looks for a camera that is tracked in a new piece of the map where it was lost, and goes on there if it succeeds.
  void return_from_piece(TrackedView& view, FrameResult& result);
  /// How many times the extractor's features are wanted, after the share of static ones in the previous frame.
  double feature_budget() const;
  /// Gives the current frame the features of an earlier one that flow finds in its image. False if it does not, and the
  /// frame needs features of its own.
  bool follow_features(const SensorFrame& sensor_frame, FrameResult& result);
  /// The final pose of a frame with followed features. False if they do not determine it, or if the frame should become
  /// a keyframe, which needs features of its own.
  bool track_followed(TrackedView& view, FrameResult& result);
  void find_features(const SensorFrame& sensor_frame, FrameResult& result);
  /// So many inliers need no other support.
  bool is_sure(int inliers) const;
  /// The pose, on which few inliers agree, is far from where constant velocity takes the camera.
  bool contradicts_motion(int inliers) const;
  /// The pose is `factor` times farther from constant velocity than jump_distance or jump_angle.
  bool jumps(double factor) const;
  /// Whether the map of one camera explains next to nothing of what counts as static in the frame just adjusted, as
  /// where a person whom no mask shows fills the view. New points would fit any scale that such a pose goes on with.
  bool lacks_support(int inliers, int static_features) const;
  /// The pose of the current frame contradicts inertia (unless the camera was lost), is not determined well enough by
  /// its inliers, or contradicts the depth of keyframes.
  bool is_refuted(int inliers, bool was_lost);
  /// A pose found after a loss on which few inliers agree has to be confirmed by those that follow; if the camera is
  /// lost before, it and the poses since are withdrawn. No keyframe is made meanwhile.
  void confirm_recovery(bool found, int inliers);
  void withdraw_recovery();
  /// Counts the matches of the last adjustment and the static features.
  void count_matches(FrameResult& result) const;
  /// A first pose of a camera that is not lost, from the motion model or the reference keyframe.
  bool predict(FrameResult& result);
  /// Takes a first pose to the final one. False if the local map does not confirm it.
  bool refine(TrackedView& view, FrameResult& result);
  /// Estimates the pose relative to the previous frame, whose static features with depth stand in for the map: a camera
  /// that swings to an unknown view, among people, has nothing else until the mask of the next keyframe is there.
  bool track_odometry(TrackedView& view, FrameResult& result);
  bool fall_back(TrackedView& view, FrameResult& result);
  bool track_dense_depth(const TrackedView& view, FrameResult& result);
  bool predict_with_velocity(FrameResult& result);
  bool predict_with_reference(FrameResult& result);
  void evaluate_with_pose(const TrackedView& view, FrameResult& result);
  bool track_local_map(const TrackedView& view, FrameResult& result);
  bool needs_keyframe(const FrameResult& result);
  /// Whether one camera waits for the second view of its map, or the map has begun a moment ago. Such a frame is
  /// tracked backwards once the map has settled.
  bool is_of_mono_start(const FrameResult& result) const;
  void end_frame(FrameResult& result);

  const TrackingSettings settings_;
  MovingWorld& moving_world_;
  Map& map_;
  FrameBuilder builder_;
  FrameHistory history_;
  FrameMatcher matcher_;
  PoseEstimator estimator_;
  Relocaliser relocaliser_;
  BackwardTracker backwards_;
  KeyframePolicy keyframe_policy_;
  std::optional<MonoInitialiser> mono_;
  std::optional<FeatureFlow> flow_;
  RollingShutter shutter_;

  State state_;
  bool localises_only_ = false;
  bool begins_with_two_views_ = false;
  bool begins_piece_ = false;
  bool start_is_judged_ = false;
  std::size_t pieces_ = 0;
  bool gave_map_up_ = false;
  int weak_starts_ = 0;
  double start_support_ = 0.0;  // sum over the frames that judge the start
  int start_frames_ = 0;        // their number
  Frame current_, previous_;
  std::vector<OdometryMatch> odometry_;
  cv::Mat ignored_;          // pixels of the current frame in which no features should be extracted
  int followed_frames_ = 0;  // in a row, up to the current frame, that have features of an earlier one
  /// The last and the reference keyframe when the camera was lost before it began a piece; invalid if it did not.
  KeyFrameId left_keyframe_, left_reference_;
  KeyFrameId reference_keyframe_;
  KeyFrameId last_keyframe_;
  double last_keyframe_time_ = 0.0;  // [s]
  struct Recovery {
    FrameHistory::Mark before;
    int frames = 1;
  };
  std::optional<Recovery> unconfirmed_;  // since the last loss
  std::size_t withdrawn_ = 0;            // frames
  std::optional<double> found_time_;     // when the camera was found after its last loss [s]
  // [s], of the frame that began the map, or began it anew; a loaded map began long ago
  double map_start_time_ = -std::numeric_limits<double>::infinity();
  double last_feature_time_ = 0.0;     // [s], of the last pose that matches with the map determined
  bool odometry_extends_map_ = false;  // the pose of this frame is by odometry, and certain enough for a keyframe
};

}  // namespace holdfast
