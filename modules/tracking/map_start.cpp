// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/map_start.hpp"

#include <algorithm>
#include <cmath>

#include "holdfast/tracking/view_motion.hpp"

namespace holdfast {

namespace {

/// Corrects the rolling shutter of the current frame before there is a map that could tell the motion of the camera.
/// False if its rotation is not known: two views with rows displaced by a fast rotation begin a wrong map.
bool correct_rows_without_map(TrackingContext& context, const FeatureMatcher& matcher, const SensorFrame& sensor_frame,
                              StageTimes& times) {
  Frame& frame = context.current;
  const bool is_first = context.previous.size() == 0;
  const bool was_paused = !is_first && frame.timestamp - context.previous.timestamp > FrameMotion::longest_interval;
  if (!context.shutter.is_active() || was_paused) return true;
  const float max_distance =
      distance_limit(context.settings.strict_distance, frame.features.descriptors.type().strict_distance);
  constexpr int rounds = 2;  // the second one compares corrected features
  for (int round = 0; round < rounds; ++round) {
    const std::optional<FrameMotion> motion = rotation_since(context.previous, frame, matcher, max_distance);
    if (!motion) return false;
    context.builder.place_features(sensor_frame, *motion, false, context.shutter, context.map, frame, times);
  }
  return true;
}

}  // namespace

void MapStart::mark_begun(FrameResult& result) {
  time_ = context_.last_feature_time = context_.current.timestamp;
  result.status = TrackingStatus::initialised;
  result.method = TrackingMethod::none;
  result.failure = TrackingFailure::none;
  result.is_keyframe = true;
  result.inliers = 0;
}

std::unique_ptr<MapStart> make_map_start(TrackingContext& context, const TrackerParts& parts) {
  if (context.features_have_depth) return std::make_unique<DepthStart>(context);
  return std::make_unique<TwoViewStart>(context, parts);
}

DepthStart::DepthStart(TrackingContext& context)
    : MapStart(context), is_judged_(context.settings.start_share <= 0.0 || !context.map.keyframes().empty()) {}

bool DepthStart::begin(const SensorFrame& sensor_frame, FrameResult& result) {
  if (context_.moving_world.has_mask()) {
    context_.moving_world.evaluate(FilterStage::before_matching, {sensor_frame, nullptr, context_.current},
                                   result.times);
    if (!has_static_depth()) {
      result.failure = TrackingFailure::few_features;
      return false;
    }
  }
  return begin_at(Eigen::Isometry3d::Identity(), result);
}

bool DepthStart::begin_at(const Eigen::Isometry3d& T_camera_world, FrameResult& result) {
  Frame& frame = context_.current;
  if (context_.depth.is_pair_exchanged(frame)) {
    result.failure = TrackingFailure::exchanged_pair;
    return false;
  }
  const int minimum = context_.settings.minimum_start_points;
  int with_depth = 0;
  for (std::size_t i = 0; i < frame.size(); ++i) with_depth += frame.has_depth(i) ? 1 : 0;
  if (with_depth < minimum) {
    result.failure = result.features < minimum ? TrackingFailure::few_features : TrackingFailure::no_depth;
    return false;
  }
  frame.T_camera_world = T_camera_world;
  context_.drop_matches();
  mark_begun(result);
  return true;
}

bool DepthStart::begin_submap(const Eigen::Isometry3d& T_camera_world, FrameResult& result) {
  return has_static_depth() && begin_at(T_camera_world, result);
}

/// Weights the features; whether enough static ones have depth for a map to begin with them.
bool DepthStart::has_static_depth() {
  Frame& frame = context_.current;
  context_.moving_world.weight_features(frame);
  int usable = 0;
  for (std::size_t i = 0; i < frame.size(); ++i) usable += frame.has_depth(i) && is_static(frame, i) ? 1 : 0;
  return usable >= context_.settings.minimum_start_points;
}

StartVerdict DepthStart::judge_by_mask() {
  if (is_judged_ || !context_.moving_world.has_mask()) return StartVerdict::pending;
  is_judged_ = true;
  if (context_.localises_only || context_.map.keyframes().empty()) return StartVerdict::pending;
  const Frame& first = context_.map.keyframe(context_.map.keyframes_by_age().front()).frame;
  int kept = 0, usable = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (!is_static(first, i)) continue;
    ++kept;
    usable += first.has_depth(i) ? 1 : 0;
  }
  // Where little is left to begin with, a map that is wrong in part is better than none.
  const bool is_refuted = kept < context_.settings.start_share * static_cast<double>(first.size()) &&
                          usable >= context_.settings.minimum_start_points;
  return is_refuted ? StartVerdict::refuted : StartVerdict::confirmed;
}

bool DepthStart::is_provisional() const {
  return !is_judged_ && context_.moving_world.expects_masks() && !context_.moving_world.has_mask();
}

std::optional<int> DepthStart::kept_frames(TrackerState, const FrameResult&) const {
  return is_provisional() ? std::optional(context_.settings.provisional_frames) : std::nullopt;
}

TwoViewStart::TwoViewStart(TrackingContext& context, const TrackerParts& parts)
    : MapStart(context),
      matcher_(parts.matcher),
      initialiser_(context.settings, parts.optimizer, parts.seed, parts.matcher) {}

bool TwoViewStart::begin(const SensorFrame& sensor_frame, FrameResult& result) {
  MovingWorld& moving_world = context_.moving_world;
  if (moving_world.expects_masks() && !moving_world.has_mask()) {
    result.failure = TrackingFailure::no_mask;
    return false;
  }
  moving_world.evaluate(FilterStage::before_matching, {sensor_frame, nullptr, context_.current}, result.times);
  moving_world.weight_features(context_.current);
  const StageTimer timer(result.times, "initialisation");
  const bool is_first = context_.previous.size() == 0;
  if (static_cast<int>(static_features(context_.current).size()) >= context_.settings.minimum_start_points &&
      !correct_rows_without_map(context_, matcher_, sensor_frame, result.times)) {
    result.failure = is_first ? TrackingFailure::little_parallax : TrackingFailure::few_matches;
    return false;
  }
  result.failure = initialiser_.add(context_.current);
  if (result.failure != TrackingFailure::none) return false;
  support_ = 0.0;
  frames_ = 0;
  mark_begun(result);
  result.inliers = static_cast<int>(initialiser_.start().points.size());
  return true;
}

bool TwoViewStart::is_weak(const FrameResult& result) {
  const TrackingSettings& settings = context_.settings;
  const double settling_time = settings.start_settling_time;
  const double age = context_.current.timestamp - time();
  if (age >= settings.start_support_age && age <= settling_time && result.matches > 0) {
    // How many of the static features are in the map, times how many of those agree with the pose.
    const double inliers = result.inliers, found = result.matches, seen = std::max(result.static_features, 1);
    support_ += inliers / seen * inliers / found;
    ++frames_;
  }
  if (age <= settling_time || frames_ == 0) return false;
  const double support = support_ / frames_;
  frames_ = 0;
  support_ = 0.0;
  // A place without texture may offer no better start: each further one needs half as much.
  if (support >= std::ldexp(settings.start_support, -weak_starts_)) return false;
  ++weak_starts_;
  return true;
}

bool TwoViewStart::is_provisional() const {
  return context_.current.timestamp - time() <= context_.settings.start_settling_time;
}

std::optional<int> TwoViewStart::kept_frames(TrackerState state, const FrameResult& result) const {
  // Without a mask no features are weighted yet.
  const bool waits = state == TrackerState::waiting && result.failure != TrackingFailure::no_mask;
  if (waits || state == TrackerState::provisional) return context_.settings.backward_frames;
  return std::nullopt;
}

void TwoViewStart::map_begun(KeyFrameId reference, const std::vector<MapPointId>& points) {
  const TwoViewMap& start = initialiser_.start();
  for (std::size_t i = 0; i < points.size(); ++i) context_.current.map_points[start.points[i].in_frame] = points[i];
  context_.history.add_before_last(reference, start.reference.timestamp);
}

}  // namespace holdfast
