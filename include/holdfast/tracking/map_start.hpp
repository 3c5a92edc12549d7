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

/// Judgement of the start of a map by the first mask.
enum class StartVerdict {
  pending,    ///< no mask yet, or nothing to judge
  confirmed,  ///< enough of the first keyframe is static
  refuted,    ///< it shows mostly what can move: the map should begin again
};

/// Begins maps, judges how they began, and forgets them. DepthStart needs one frame with depth, TwoViewStart two views
/// of one camera. Tracker calls it while there is no map, after losses, and to judge the start, in its
/// thread and within its MapAccess.
class MapStart {
 public:
  /// The context must outlive the object.
  explicit MapStart(TrackingContext& context) : context_(context) {}
  virtual ~MapStart() = default;
  MapStart(const MapStart&) = delete;
  MapStart& operator=(const MapStart&) = delete;

  /// Tries to begin the map with the current frame. True: the frame has its pose and becomes a keyframe.
  virtual bool begin(const SensorFrame& sensor_frame, FrameResult& result) = 0;
  /// Whether a map can go on at a given pose after a loss; otherwise a map that is lost right after its start is given
  /// up.
  virtual bool continues_after_loss() const = 0;
  /// Makes the current frame, at this T_camera_world, the first keyframe after a loss. False if it shows too little.
  virtual bool begin_at(const Eigen::Isometry3d& T_camera_world, FrameResult& result) = 0;
  /// The same if enough static features, by the present mask, have depth.
  virtual bool begin_submap(const Eigen::Isometry3d& T_camera_world, FrameResult& result) = 0;

  /// Whether a tracked frame shows that the map began wrong.
  virtual bool is_weak(const FrameResult& result) = 0;
  virtual StartVerdict judge_by_mask() = 0;
  /// Whether the start has not been judged yet.
  virtual bool is_provisional() const = 0;
  /// How many frames are kept to be tracked backwards from the map once its start has been judged; empty when the
  /// current frame does not belong to the start.
  virtual std::optional<int> kept_frames(TrackerState state, const FrameResult& result) const = 0;

  /// The map was removed.
  virtual void forget() = 0;

  /// The request for a map that this object has just begun.
  virtual MapRequest request() const { return {.kind = MapRequest::Kind::first_keyframe}; }
  /// Whether a mask is needed to begin with.
  virtual bool wants_mask(TrackerState) const { return false; }
  /// The first of two views became `reference`, and its points, in their order, became `points`.
  virtual void map_begun(KeyFrameId, const std::vector<MapPointId>&) {}

  /// Time stamp of the frame that began the map, or began it anew [s]; a loaded map began long ago.
  double time() const { return time_; }

 protected:
  /// The current frame begins a map: sets the time and the result.
  void mark_begun(FrameResult& result);

  TrackingContext& context_;

 private:
  double time_ = -std::numeric_limits<double>::infinity();
};

/// Begins the map with one frame whose features have depth. A start before the first mask is provisional: if the mask
/// shows that the first keyframe was mostly on what can move (TrackingSettings::start_share), it is refuted.
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

/// Begins the map of one camera with two views (MonoInitialiser), once a mask tells where people are if masks are
/// expected. From the frames start_support_age to start_settling_time after the start it judges whether the map grows
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
  /// The first two views should be chosen by masks that are as fresh as they can be.
  bool wants_mask(TrackerState state) const override { return state == TrackerState::waiting; }
  void map_begun(KeyFrameId reference, const std::vector<MapPointId>& points) override;

 private:
  MonoInitialiser initialiser_;
  int weak_starts_ = 0;
  double support_ = 0.0;  // sum over the frames that judge the start
  int frames_ = 0;        // their number
};

/// The start for features with depth or without.
std::unique_ptr<MapStart> make_map_start(TrackingContext& context, const TrackerParts& parts);

}  // namespace holdfast
