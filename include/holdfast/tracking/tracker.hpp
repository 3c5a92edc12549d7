// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/map_access.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/tracking/first_pose.hpp"
#include "holdfast/tracking/frame_following.hpp"
#include "holdfast/tracking/frame_tracker.hpp"
#include "holdfast/tracking/health_judge.hpp"
#include "holdfast/tracking/inertial_smoothing.hpp"
#include "holdfast/tracking/keyframe_decision.hpp"
#include "holdfast/tracking/loss_record.hpp"
#include "holdfast/tracking/loss_recovery.hpp"
#include "holdfast/tracking/map_request.hpp"
#include "holdfast/tracking/map_start.hpp"
#include "holdfast/tracking/pose_covariance.hpp"
#include "holdfast/tracking/tracker_state.hpp"
#include "holdfast/tracking/tracking_context.hpp"
#include "holdfast/tracking/trajectory_smoothing.hpp"

namespace holdfast {

/// Tracking (Mur-Artal and Tardos 2017, section III): estimates the pose of every frame against the map and requests
/// keyframes. It is the state machine of TrackerState with three components: FrameTracker finds the pose of one frame,
/// MapStart initialises maps, LossRecovery handles losses.
///
/// The pipeline calls, for each frame and in this order: judge_start(), begin(), locate(), and keyframe_added() for a
/// frame that became a keyframe. The tracker writes to the map only its observations of points: how often they are
/// visible and found, and their static log-odds (through MovingWorld). Not thread-safe: one thread calls it.
/// Functions that use the map take a MapAccess.
class Tracker {
 public:
  /// With keyframes in the map the tracker starts in the state lost and must relocalise first.
  Tracker(const TrackingSettings& settings, const TrackerParts& parts, FirstPoses first_poses = default_first_poses());
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;

  /// Localisation mode: no further frames become keyframes.
  void localise_only() { context_.localises_only = true; }

  /// Throws InputError for images that begin() would refuse.
  void check_images(const SensorFrame& sensor_frame) const { context_.builder.check_images(sensor_frame); }
  /// True if the first mask has arrived and covers most of the first keyframe with movable objects. The caller must
  /// then clear the map and call forget_map(); the next frame initialises another map, from which earlier frames are
  /// tracked backwards.
  bool judge_start(const MapAccess& map);
  /// First half of a frame: propagates the mask and extracts features. It does not read the map.
  void begin(const SensorFrame& sensor_frame, FrameResult& result);
  /// Second half: estimates the pose. The caller carries out the request before the next frame.
  MapRequest locate(const MapAccess& map, const SensorFrame& sensor_frame, FrameResult& result);
  /// For MapRequest::Kind::two_views: takes over the id of the first view, inserted as a keyframe, and the ids of the
  /// initial points, in their order.
  void map_begun(const MapAccess&, KeyFrameId reference, const std::vector<MapPointId>& points) {
    start_->map_begun(reference, points);
  }
  /// Takes over matches and pose of the keyframe made of the last frame, as changed by local mapping.
  void keyframe_added(const MapAccess& map, KeyFrameId keyframe);
  /// Resets tracking to the state before the first frame. The caller has emptied the map.
  void forget_map(const MapAccess& map);
  /// Ends tracking: withdraws unconfirmed poses after a loss, tracks kept frames backwards, and, until `stop`, locates
  /// others in the map.
  void finish(const MapAccess&, StageTimes& times, const std::atomic<bool>& stop) { recovery_.finish(times, stop); }

  PlacedFrames placed_frames(const MapAccess& map) const {
    return holdfast::placed_frames(context_.history, map.map());
  }
  /// Moves frames as the last adjustments moved the keyframes before and after them (frame_following.hpp).
  void follow_keyframes(const MapAccess& map, const PlacedFrames& before) {
    holdfast::follow_keyframes(context_.history, map.map(), before);
  }
  RunPath path_of_run(const MapAccess& map, const InertialHistory& inertia) const {
    return path_of(context_.history, map.map(), inertia);
  }
  /// Estimates the poses between keyframes again by the map as it is now, at the end of a run.
  void smooth_by_inertia(const MapAccess& map, const UnplacedFrames& unplaced, const InertialHistory& inertia,
                         Optimizer& optimizer, const std::atomic<bool>& stop) {
    placed_by_inertia_ +=
        holdfast::smooth_by_inertia(context_.history, map.map(), unplaced, inertia, optimizer, stop).placed;
  }

  /// Smooths the trajectory at the end of a run, if the settings say so (trajectory_smoothing.hpp).
  void smooth_trajectory(const MapAccess& map, StageTimes& times) {
    if (!context_.settings.smooth_trajectory) return;
    const StageTimer timer(times, "smooth trajectory");
    holdfast::smooth_trajectory(context_.history, map.map());
  }

  /// The last tracked frame, with features, matches and pose.
  const Frame& frame() const { return context_.current; }
  TrackerState state() const { return state_; }
  /// Statistics of the frames around losses so far.
  LossRecord loss_record(const MapAccess&) const {
    LossRecord record = recovery_.record();
    record.placed_by_inertia = placed_by_inertia_;
    return record;
  }
  /// The rolling-shutter correction with its estimated readout time.
  const RollingShutter& rolling_shutter() const { return context_.shutter; }
  /// The submap with most of the tracked frames.
  std::uint32_t main_submap(const MapAccess& map) const { return context_.history.main_submap(map.map()); }
  /// Estimates from inertial measurements in the world of a submap: of this run, or else of the map that it continues.
  std::optional<MapInertia> inertia_of(const MapAccess& map, std::uint32_t submap) const;
  /// Direction of gravity in the frame of the camera at the last frame, a unit vector; empty unless inertial
  /// measurements determine it.
  std::optional<Eigen::Vector3d> vertical(const MapAccess& map) const;
  /// Current poses of the tracked frames of the main submap. Poses are stored relative to keyframes, so that
  /// corrections of the map move them.
  Trajectory trajectory(const MapAccess& map) const { return context_.history.trajectory(map.map()); }
  /// Current T_world_camera of the frame with this time stamp; empty without a pose in the map.
  std::optional<Eigen::Isometry3d> pose_at(const MapAccess& map, double timestamp) const {
    const auto pose = context_.history.past_pose(timestamp, map.map());
    return pose ? std::optional(pose->T_camera_world.inverse()) : std::nullopt;
  }

 private:
  MapRequest begin_map(const SensorFrame& sensor_frame, FrameResult& result);
  MapRequest track(const SensorFrame& sensor_frame, FrameResult& result);
  MapRequest answer_loss(FrameResult& result);
  void found_pose(FrameResult& result);
  void enter_found_state();
  void end_frame(FrameResult& result);
  bool fuse_with_inertia(FrameResult& result);
  void calibrate_covariance(FrameResult& result);
  void follow_inertia(FrameResult& result);

  TrackingContext context_;
  KeyframeDecision keyframes_;
  FrameTracker frame_tracker_;
  std::unique_ptr<MapStart> start_;
  LossRecovery recovery_;
  HealthJudge health_;
  PoseCovariance covariance_;
  TrackerState state_;
  std::size_t placed_by_inertia_ = 0;  // frames
};

}  // namespace holdfast
