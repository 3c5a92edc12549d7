// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/map_access.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/tracking/first_pose.hpp"
#include "holdfast/tracking/frame_tracker.hpp"
#include "holdfast/tracking/keyframe_decision.hpp"
#include "holdfast/tracking/loss_record.hpp"
#include "holdfast/tracking/loss_recovery.hpp"
#include "holdfast/tracking/map_request.hpp"
#include "holdfast/tracking/map_start.hpp"
#include "holdfast/tracking/tracker_state.hpp"
#include "holdfast/tracking/tracking_context.hpp"

namespace holdfast {

/// Tracking (Mur-Artal and Tardos 2017, section III): estimates the pose of every frame against the map and requests
/// keyframes. It is the state machine of TrackerState around three rooms: FrameTracker finds the pose of one frame,
/// MapStart begins maps, LossRecovery deals with losses.
///
/// The pipeline calls, for each frame and in this order: judge_start(), begin(), locate(), and keyframe_added() for a
/// frame that became a keyframe. The tracker writes to the map only its observations of points: how often they are
/// visible and found, and their static log-odds (through MovingWorld). One thread. Functions that use the map take a
/// MapAccess.
class Tracker {
 public:
  /// With keyframes in the map the tracker begins lost and has to relocalise first.
  Tracker(const TrackingSettings& settings, const TrackerParts& parts, FirstPoses first_poses = default_first_poses());
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;

  /// From now on no frame becomes a keyframe.
  void localise_only() { context_.localises_only = true; }

  /// Throws InputError for images that begin() would refuse.
  void check_images(const SensorFrame& sensor_frame) const { context_.builder.check_images(sensor_frame); }
  /// Whether the first mask, which has just arrived, shows that the map began on what moves: then remove all of it,
  /// call forget_map(), and the next frame begins another one, from which those before it are tracked backwards.
  bool judge_start(const MapAccess& map);
  /// First half of a frame: propagates the mask and extracts features. It does not read the map.
  void begin(const SensorFrame& sensor_frame, FrameResult& result);
  /// Second half: estimates the pose. The caller carries out the request before the next frame.
  MapRequest locate(const MapAccess& map, const SensorFrame& sensor_frame, FrameResult& result);
  /// For MapRequest::Kind::two_views: the first view became `reference`, and its points, in their order, `points`.
  void map_begun(const MapAccess&, KeyFrameId reference, const std::vector<MapPointId>& points) {
    start_->map_begun(reference, points);
  }
  /// Takes over the matches and the pose of the keyframe that the frame became, as local mapping left them.
  void keyframe_added(const MapAccess& map, KeyFrameId keyframe);
  /// As if no frame had been tracked. The map is empty.
  void forget_map(const MapAccess& map);
  /// No frame follows: withdraws poses after a loss that nothing has confirmed, and tracks kept frames backwards.
  void finish(const MapAccess&, StageTimes& times) { recovery_.finish(times); }

  /// The frame last tracked, with features, matches and pose.
  const Frame& frame() const { return context_.current; }
  TrackerState state() const { return state_; }
  /// Counts of frames around losses until now.
  LossRecord loss_record(const MapAccess&) const { return recovery_.record(); }
  /// The rolling-shutter correction with its estimated readout time.
  const RollingShutter& rolling_shutter() const { return context_.shutter; }
  /// The submap with most of the tracked frames.
  std::uint32_t main_submap(const MapAccess& map) const { return context_.history.main_submap(map.map()); }
  /// Every tracked frame's pose by the map as it is now. Frames follow the keyframes that they were tracked against.
  Trajectory trajectory(const MapAccess& map) const { return context_.history.trajectory(map.map()); }

 private:
  MapRequest begin_map(const SensorFrame& sensor_frame, FrameResult& result);
  MapRequest track(const SensorFrame& sensor_frame, FrameResult& result);
  MapRequest answer_loss(FrameResult& result);
  void found_pose(FrameResult& result);
  void enter_found_state();
  void end_frame(FrameResult& result);

  TrackingContext context_;
  KeyframeDecision keyframes_;
  FrameTracker frame_tracker_;
  std::unique_ptr<MapStart> start_;
  LossRecovery recovery_;
  TrackerState state_;
};

}  // namespace holdfast
