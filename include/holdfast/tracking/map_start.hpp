// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/id.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/tracking/map_request.hpp"
#include "holdfast/tracking/mono_initialiser.hpp"
#include "holdfast/tracking/tracker_state.hpp"
#include "holdfast/tracking/tracking_context.hpp"

namespace holdfast {

/// Verification of the first keyframe by the first mask.
enum class StartVerdict {
  pending,    ///< no mask yet, or nothing to verify
  confirmed,  ///< enough of the first keyframe is static
  refuted,    ///< it shows mostly movable objects: the map should be restarted
};

/// Map initialisation and its verification: from one frame with depth (DepthStart) or from two monocular views
/// (TwoViewStart). Called by Tracker while there is no map, after losses, and to verify the start, in its thread and
/// within its MapAccess.
class MapStart {
 public:
  /// The context must outlive the object.
  explicit MapStart(TrackingContext& context) : context_(context) {}
  virtual ~MapStart() = default;
  MapStart(const MapStart&) = delete;
  MapStart& operator=(const MapStart&) = delete;

  /// Tries to initialise the map with the current frame. If true, the frame has a pose and becomes a keyframe.
  virtual bool begin(const SensorFrame& sensor_frame, FrameResult& result) = 0;
  /// Whether a map can be continued at a predicted pose after a loss. Otherwise a map lost right after its start is
  /// removed.
  virtual bool continues_after_loss() const = 0;
  /// Makes the current frame, with this T_camera_world, the first keyframe after a loss. False if it has too few
  /// features.
  virtual bool begin_at(const Eigen::Isometry3d& T_camera_world, FrameResult& result) = 0;
  /// Like begin_at() for a new submap; also requires enough static features with depth according to the current mask.
  virtual bool begin_submap(const Eigen::Isometry3d& T_camera_world, FrameResult& result) = 0;

  /// Whether a tracked frame indicates a failed initialisation.
  virtual bool is_weak(const FrameResult& result) = 0;
  virtual StartVerdict judge_by_mask() = 0;
  /// True until the start has been verified.
  virtual bool is_provisional() const = 0;
  /// Number of frames to keep for backward tracking after the verification; empty if the current frame does not belong
  /// to the start.
  virtual std::optional<int> kept_frames(TrackerState state, const FrameResult& result) const = 0;

  /// Resets the state after the map was removed.
  virtual void forget() = 0;

  /// The request after a successful begin().
  virtual MapRequest request() const { return {.kind = MapRequest::Kind::first_keyframe}; }
  /// Whether the initialisation needs a mask.
  virtual bool wants_mask(TrackerState) const { return false; }
  /// Registers the ids of a two-view map: `reference` is the keyframe of the first view, `points` are the initial
  /// points in their order.
  virtual void map_begun(KeyFrameId, const std::vector<MapPointId>&) {}

  /// Time stamp of the frame that started or restarted the map [s]; far in the past for a loaded map.
  double time() const { return time_; }

 protected:
  /// Sets the time and the result for a current frame that starts a map.
  void mark_begun(FrameResult& result);

  TrackingContext& context_;

 private:
  double time_ = -std::numeric_limits<double>::infinity();
};

/// Initialises the map from one frame whose features have depth. A start before the first mask is provisional, and is
/// refuted if the mask covers most features of the first keyframe with movable objects (TrackingSettings::start_share).
class DepthStart final : public MapStart {
 public:
  explicit DepthStart(TrackingContext& context);
  bool begin(const SensorFrame& sensor_frame, FrameResult& result) override;
  bool continues_after_loss() const override { return true; }
  bool begin_at(const Eigen::Isometry3d& T_camera_world, FrameResult& result) override;
  bool begin_submap(const Eigen::Isometry3d& T_camera_world, FrameResult& result) override;
  bool is_weak(const FrameResult&) override { return false; }
  StartVerdict judge_by_mask() override;
  bool is_provisional() const override;
  std::optional<int> kept_frames(TrackerState state, const FrameResult& result) const override;
  void forget() override {}

 private:
  bool has_static_depth();

  bool is_judged_;
};

/// Initialises a monocular map from two views (MonoInitialiser), with a segmenter only after the first mask. The frames
/// from start_support_age to start_settling_time after the start verify that the map grows
/// (TrackingSettings::start_support).
class TwoViewStart final : public MapStart {
 public:
  TwoViewStart(TrackingContext& context, const TrackerParts& parts);
  bool begin(const SensorFrame& sensor_frame, FrameResult& result) override;
  bool continues_after_loss() const override { return false; }
  bool begin_at(const Eigen::Isometry3d&, FrameResult&) override { return false; }
  bool begin_submap(const Eigen::Isometry3d&, FrameResult&) override { return false; }
  bool is_weak(const FrameResult& result) override;
  StartVerdict judge_by_mask() override { return StartVerdict::pending; }
  bool is_provisional() const override;
  std::optional<int> kept_frames(TrackerState state, const FrameResult& result) const override;
  void forget() override { initialiser_.forget(); }
  MapRequest request() const override {
    return {.kind = MapRequest::Kind::two_views, .two_views = &initialiser_.start()};
  }
  /// Frames are segmented while waiting, so that the two views are selected with recent masks.
  bool wants_mask(TrackerState state) const override { return state == TrackerState::waiting; }
  void map_begun(KeyFrameId reference, const std::vector<MapPointId>& points) override;

 private:
  const FeatureMatcher& matcher_;
  MonoInitialiser initialiser_;
  int weak_starts_ = 0;
  double support_ = 0.0;  // sum over the frames that judge the start
  int frames_ = 0;        // their number
};

/// Creates the initialisation for features with or without depth.
std::unique_ptr<MapStart> make_map_start(TrackingContext& context, const TrackerParts& parts);

}  // namespace holdfast
