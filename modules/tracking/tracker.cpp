// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/tracker.hpp"

#include <utility>

#include "holdfast/core/after_loss.hpp"
#include "holdfast/geometry/se3.hpp"
#include "holdfast/tracking/age_disagreement.hpp"

namespace holdfast {

Tracker::Tracker(const TrackingSettings& settings, const TrackerParts& parts, FirstPoses first_poses)
    : context_(settings, parts),
      keyframes_(context_),
      frame_tracker_(context_, keyframes_, std::move(first_poses)),
      start_(make_map_start(context_, parts)),
      recovery_(context_, frame_tracker_.local_map()),
      health_(settings),
      state_(parts.map.keyframes().empty() ? TrackerState::waiting : TrackerState::lost) {}

bool Tracker::judge_start(const MapAccess&) {
  const StartVerdict verdict = start_->judge_by_mask();
  if (verdict == StartVerdict::confirmed) recovery_.forget_frames();
  return verdict == StartVerdict::refuted;
}

void Tracker::begin(const SensorFrame& sensor_frame, FrameResult& result) {
  result.index = sensor_frame.index;
  result.timestamp = sensor_frame.timestamp;
  covariance_.begin_frame();
  frame_tracker_.begin(sensor_frame, state_, result);
}

MapRequest Tracker::locate(const MapAccess&, const SensorFrame& sensor_frame, FrameResult& result) {
  MapRequest request = state_ == TrackerState::waiting ? begin_map(sensor_frame, result) : track(sensor_frame, result);
  end_frame(result);
  request.submap = context_.submap();
  request.wants_mask = start_->wants_mask(state_) || recovery_.wants_mask(state_);
  request.follows_loss = recovery_.was_just_found();
  return request;
}

MapRequest Tracker::begin_map(const SensorFrame& sensor_frame, FrameResult& result) {
  if (!start_->begin(sensor_frame, result)) return {};
  recovery_.map_begun();
  enter_found_state();
  return start_->request();
}

MapRequest Tracker::track(const SensorFrame& sensor_frame, FrameResult& result) {
  FrameHistory& history = context_.history;
  if (!history.empty()) {
    const Eigen::Isometry3d last_pose = history.last_pose(context_.map);
    context_.inertia.follow_map(last_pose);
    health_.follow_map(last_pose.inverse());
  }
  if (history.has_previous()) context_.previous.T_camera_world = history.last_pose(context_.map);
  const std::optional<InertialPrediction> prediction = context_.inertia.prediction();
  context_.current.inertial_deviation = prediction ? prediction->position_deviation : 0.0;
  TrackedView view{sensor_frame, history.has_previous() ? &context_.previous : nullptr, context_.current,
                   context_.submap(), prediction ? &*prediction : nullptr};
  const bool was_lost = state_ == TrackerState::lost;
  const PoseSituation situation{.was_lost = was_lost,
                                .may_be_anywhere = !context_.features_have_depth || recovery_.may_return(),
                                .is_unconfirmed = state_ == TrackerState::unconfirmed,
                                .map_age = context_.current.timestamp - start_->time()};
  bool found = frame_tracker_.locate(view, situation, result);
  MapRequest request;
  if (found && start_->is_weak(result)) {
    found = false;
    result.covariance.reset();
    result.failure = TrackingFailure::weak_start;
    request.kind = MapRequest::Kind::give_up;
  } else if (!found) {
    request = answer_loss(result);
    if (result.status == TrackingStatus::initialised) return request;
  }
  if (found) recovery_.try_to_return(view, situation, result);
  recovery_.confirm(found, was_lost, result.inliers);
  result.status = !found                                          ? TrackingStatus::lost
                  : result.fallback == TrackingFallback::inertial ? TrackingStatus::inertial
                                                                  : TrackingStatus::tracked;
  state_ = TrackerState::lost;
  if (!found) return request;
  enter_found_state();
  if (was_lost || !fuse_with_inertia(result)) calibrate_covariance(result);
  found_pose(result);
  if (result.is_keyframe) request.kind = MapRequest::Kind::keyframe;
  return request;
}

/// A map that was lost right after its start begins anew or is given up; a camera that is lost for long begins a
/// submap.
MapRequest Tracker::answer_loss(FrameResult& result) {
  using Kind = MapRequest::Kind;
  const bool was_lost_at_start = recovery_.was_lost_at_start(start_->time());
  if (!start_->continues_after_loss()) return {.kind = was_lost_at_start ? Kind::give_up : Kind::none};
  MapRequest request;
  if (was_lost_at_start && start_->begin_at(recovery_.coasting_pose(), result)) {
    // The first submap goes on, since frames may follow it that were tracked before.
    request.kind = context_.submap() != 0 ? Kind::new_submap : Kind::first_keyframe;
    if (request.kind == Kind::new_submap) recovery_.submap_begun(false);
  } else if (recovery_.should_begin_submap() && start_->begin_submap(recovery_.coasting_pose(), result)) {
    request.kind = Kind::new_submap;
    recovery_.submap_begun(true);
  } else {
    return request;
  }
  recovery_.map_begun();
  enter_found_state();
  return request;
}

void Tracker::enter_found_state() {
  state_ = recovery_.is_unconfirmed() ? TrackerState::unconfirmed
           : start_->is_provisional() ? TrackerState::provisional
                                      : TrackerState::tracking;
}

/// Learns from the pose, and decides on a keyframe.
void Tracker::found_pose(FrameResult& result) {
  const StageTimer timer(result.times, "keyframe");
  const bool on_map = result.inliers >= context_.settings.minimum_inliers;
  if (on_map && context_.history.has_previous())
    if (const auto motion = context_.motion_at_exposure(context_.measured_step()))
      context_.shutter.learn(*motion, context_.map, context_.current);
  result.is_keyframe = !context_.localises_only && state_ != TrackerState::unconfirmed &&
                       frame_tracker_.has_own_features() &&
                       (on_map ? keyframes_.is_due(result) : frame_tracker_.extends_map());
  if (on_map || result.is_keyframe) context_.last_feature_time = context_.current.timestamp;
  result.failure = TrackingFailure::none;
  result.objects = context_.moving_world.objects();
  if (result.is_keyframe) context_.matcher.local_map().write_counts(context_.map);  // mapping evaluates points by them
}

void Tracker::end_frame(FrameResult& result) {
  const bool is_found = has_pose(state_);
  const auto hides_most = [this] { return context_.moving_world.hides_most(context_.current.coarse); };
  context_.moving_world.end_frame(context_.current, is_found);
  if (const std::optional<int> count = start_->kept_frames(state_, result))
    recovery_.keep_frame(*count, result.times);
  else if (!is_found && context_.features_have_depth)
    recovery_.keep_frame(context_.settings.backward_frames, result.times);
  if (!is_found) {
    if (result.failure != TrackingFailure::no_mask) recovery_.keep_late_frame();
    context_.history.interrupt();
    context_.inertia.lost();
    result.health = health_.judge(result, state_, hides_most);
    return;
  }
  result.T_world_camera = context_.current.T_world_camera();
  result.health = health_.judge(result, state_, hides_most);
  if (context_.reference_keyframe.valid()) result.keyframe = context_.reference_keyframe;
  context_.history.add(context_.current, context_.reference_keyframe, context_.map);
  follow_inertia(result);
  if (result.status == TrackingStatus::tracked && state_ == TrackerState::tracking)
    recovery_.track_backwards(result.times);
}

/// A pose that few features determine is adjusted with the inertial prediction as a prior, to first order.
bool Tracker::fuse_with_inertia(FrameResult& result) {
  if (result.status != TrackingStatus::tracked || !context_.inertia.is_reliable() || !result.covariance ||
      frame_tracker_.local_map().checks().has_ample_inliers(result.inliers))
    return false;
  const bool is_relative = result.fallback == TrackingFallback::odometry;
  if (!context_.inertia.correct(context_.current.T_camera_world, *result.covariance, is_relative)) return false;
  const InertialPrediction fused = *context_.inertia.prediction();
  context_.current.T_camera_world = fused.T_camera_world;
  result.covariance = fused.covariance;
  return true;
}

void Tracker::calibrate_covariance(FrameResult& result) {
  if (result.status != TrackingStatus::tracked || !result.covariance) return;
  // Odometry places its points by the pose of the previous frame.
  const bool is_relative = result.fallback == TrackingFallback::odometry;
  const KeyFrame* reference = is_relative ? nullptr : context_.map.find_keyframe(context_.reference_keyframe);
  result.covariance = covariance_.calibrated_covariance(
      context_.estimator.problem(), *result.covariance, reference ? context_.reference_keyframe : KeyFrameId(),
      reference ? context_.current.T_camera_world * reference->frame.T_world_camera() : Eigen::Isometry3d::Identity());
  if (!is_relative && context_.features_have_depth && context_.moving_world.weights_features())
    *result.covariance += age_disagreement(context_.current, context_.map);
  if (!is_relative || !health_.last_covariance() || !context_.history.has_previous()) return;
  const auto to_current = geometry::adjoint_se3(context_.measured_step());
  *result.covariance += to_current * *health_.last_covariance() * to_current.transpose();
}

/// Inertial motion learns from the pose, unless it gave the pose itself.
void Tracker::follow_inertia(FrameResult& result) {
  if (!context_.inertia.is_used()) return;
  const StageTimer timer(result.times, "inertia");
  const Eigen::Isometry3d& T_camera_world = context_.current.T_camera_world;
  if (result.status == TrackingStatus::initialised) {
    context_.inertia.reset();
  } else if (result.status == TrackingStatus::inertial) {
    context_.inertia.bridged(T_camera_world);
  } else {
    // Found by the map alone after a bridge that drifted.
    if (is_after_loss(result.method) && context_.inertia.contradicts(T_camera_world, 1.0)) context_.inertia.relocated();
    const auto past_pose = [this](double timestamp) -> std::optional<Eigen::Isometry3d> {
      const auto pose = context_.history.past_pose(timestamp, context_.map);
      return pose ? std::optional(pose->T_camera_world) : std::nullopt;
    };
    constexpr double deviation_of_depth = 0.01;  // [m], of a pose by dense depth alone
    const double deviation = result.inliers > 0 ? context_.estimator.position_deviation() : deviation_of_depth;
    context_.inertia.found(T_camera_world, deviation, past_pose);
  }
}

std::optional<MapInertia> Tracker::inertia_of(const MapAccess& map, std::uint32_t submap) const {
  // The keyframes that were loaded with the map are those of submap 0.
  const std::optional<MapInertia> kept = submap == 0 ? map->inertia() : std::nullopt;
  const std::optional<MapInertia> found = context_.submap() == submap ? context_.inertia.estimates() : std::nullopt;
  return found ? found : kept;
}

std::optional<Eigen::Vector3d> Tracker::vertical(const MapAccess&) const {
  const std::optional<Eigen::Vector3d> gravity = context_.inertia.gravity();
  if (!gravity) return std::nullopt;
  return (context_.current.T_camera_world.linear() * *gravity).normalized();
}

void Tracker::keyframe_added(const MapAccess& map, KeyFrameId keyframe) {
  const Frame& stored = map->keyframe(keyframe).frame;
  context_.current.map_points = stored.map_points;
  context_.current.T_camera_world = stored.T_camera_world;
  context_.reference_keyframe = context_.last_keyframe = keyframe;
  health_.refined(context_.current.T_world_camera());
  keyframes_.keyframe_added(context_.current.timestamp);
  recovery_.keyframe_added(keyframe);
  covariance_.keyframe_added(keyframe);
  context_.history.became_keyframe(keyframe, context_.current.timestamp);
}

void Tracker::forget_map(const MapAccess&) {
  context_.forget_map();
  keyframes_.forget_map();
  frame_tracker_.forget_map();
  start_->forget();
  recovery_.forget_map();
  health_.forget_map();
  covariance_.forget_map();
  state_ = TrackerState::waiting;
}

}  // namespace holdfast
