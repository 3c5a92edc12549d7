// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/frame_tracker.hpp"

#include <algorithm>
#include <utility>

namespace holdfast {

FrameTracker::FrameTracker(TrackingContext& context, const KeyframeDecision& keyframes, FirstPoses first_poses)
    : context_(context), local_map_(context), first_poses_(std::move(first_poses)) {
  if (context.settings.between_keyframes == BetweenKeyframes::flow) flow_.emplace(context, local_map_, keyframes);
}

void FrameTracker::begin(const SensorFrame& sensor_frame, TrackerState state, FrameResult& result) {
  std::swap(context_.current, context_.previous);
  Frame& frame = context_.current;
  context_.builder.begin(sensor_frame, frame, result.times);
  if (context_.inertia.is_used()) {
    const StageTimer timer(result.times, "inertia");
    context_.inertia.begin_frame(sensor_frame);
  }
  ignored_ = context_.moving_world.begin_frame(context_.builder.grey(), context_.predicted_step(), frame, result.times);
  if (!flow_ || !flow_->follow(sensor_frame, ignored_, has_pose(state), result))
    find_features(sensor_frame, state != TrackerState::waiting, result);
}

void FrameTracker::find_features(const SensorFrame& sensor_frame, bool has_map, FrameResult& result) {
  if (flow_) flow_->stop();
  context_.builder.set_budget(feature_budget(has_map));
  context_.builder.find_features(sensor_frame, ignored_, context_.current, result.times);
  if (context_.history.has_velocity()) context_.place_features(sensor_frame, context_.predicted_step(), result.times);
  result.features = static_cast<int>(context_.current.size());
}

double FrameTracker::feature_budget(bool has_map) const {
  if (!has_map || context_.previous.size() == 0) return 1.0;
  const auto& probability = context_.previous.static_probability;
  const auto kept = std::count_if(probability.begin(), probability.end(), [](float p) { return is_static(p); });
  const double share = static_cast<double>(kept) / static_cast<double>(context_.previous.size());
  return std::clamp(context_.settings.feature_boost_below / std::max(share, 1e-3), 1.0,
                    context_.settings.feature_boost);
}

bool FrameTracker::locate(TrackedView& view, const PoseSituation& situation, FrameResult& result) {
  extends_map_ = false;
  if (!has_own_features()) {
    if (flow_->track(view, result)) return true;
    find_features(view.sensor_frame, true, result);
  }
  context_.moving_world.evaluate(FilterStage::before_matching, view, result.times);
  return find_pose(view, situation, result);
}

bool FrameTracker::find_pose(TrackedView& view, const PoseSituation& situation, FrameResult& result) {
  PoseSearch search{context_, local_map_, situation, view, result};
  for (const auto& method : first_poses_) {
    const FirstPoseOutcome outcome = method->find(search);
    extends_map_ = search.extends_map;
    if (outcome == FirstPoseOutcome::final_pose ||
        (outcome == FirstPoseOutcome::first_pose && local_map_.refine(view, situation, result)))
      return true;
    result.fallback = TrackingFallback::none;
  }
  return false;
}

void FrameTracker::forget_map() {
  if (flow_) flow_->forget();
}

}  // namespace holdfast
