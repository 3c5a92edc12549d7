// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/loss_recovery.hpp"

#include <algorithm>

namespace holdfast {

LossRecovery::LossRecovery(TrackingContext& context, const LocalMapRefinement& local_map)
    : context_(context),
      local_map_(local_map),
      backwards_(context.settings,
                 {context.map, context.moving_world, context.matcher, context.estimator, context.history}),
      late_(context.settings, {context.map, context.matcher, context.estimator, context.history}) {}

bool LossRecovery::was_lost_at_start(double map_start) const {
  const FrameHistory& history = context_.history;
  if (context_.localises_only || history.empty()) return false;
  // The next frames or a mask that is on its way may help; the longer the map has been tracked by, the longer it is
  // worth waiting for a view of it.
  const TrackingSettings& settings = context_.settings;
  const double age = history.last_timestamp() - map_start;
  const double lost_for = context_.current.timestamp - history.last_timestamp();
  return age < settings.young_map_time &&
         lost_for > std::max(settings.young_map_patience, settings.young_map_share * age);
}

bool LossRecovery::should_begin_submap() const {
  const TrackingSettings& settings = context_.settings;
  if (context_.localises_only || context_.history.empty() || settings.restart_time <= 0.0) return false;
  if (context_.current.timestamp - context_.history.last_timestamp() <= settings.restart_time) return false;
  // A submap that began on people would never fit the rest.
  const MovingWorld& moving_world = context_.moving_world;
  return !moving_world.expects_masks() ||
         (moving_world.has_mask() && moving_world.mask_age() <= settings.keyframe_mask_age);
}

Eigen::Isometry3d LossRecovery::coasting_pose() const {
  const FrameHistory& history = context_.history;
  const double now = context_.current.timestamp;
  const bool coasts = now <= history.last_timestamp() + context_.settings.coasting_time;
  return history.extrapolate(now, coasts ? 1.0 : 0.0) * history.last_pose(context_.map);
}

void LossRecovery::submap_begun(bool may_return) {
  ++submaps_;
  if (!may_return || left_reference_.valid()) return;
  left_keyframe_ = context_.last_keyframe;
  left_reference_ = context_.reference_keyframe;
}

void LossRecovery::try_to_return(TrackedView& view, const PoseSituation& situation, FrameResult& result) {
  if (!may_return()) return;
  // A loop has joined the two, or the camera is back.
  if (context_.map.submap_of(left_reference_).value_or(context_.submap()) == context_.submap()) {
    left_keyframe_ = left_reference_ = KeyFrameId();
    return;
  }
  if (result.index % static_cast<std::uint64_t>(context_.settings.return_interval) != 0) return;
  const Frame in_submap = context_.current;
  const KeyFrameId reference = context_.reference_keyframe;
  FrameResult trial = result;
  bool found = false;
  {
    const StageTimer timer(result.times, "relocalisation");
    found = context_.relocaliser.recover(left_keyframe_, left_reference_, context_.current, trial);
  }
  if (!found || !local_map_.track_local_map(view, situation, trial) ||
      trial.inliers < context_.settings.relocalisation_inliers) {
    context_.current = in_submap;
    context_.reference_keyframe = reference;
    return;
  }
  trial.times = result.times;
  result = trial;
  context_.history.interrupt();
  context_.inertia.reset();  // gravity was that of the submap
  left_keyframe_ = left_reference_ = KeyFrameId();
}

void LossRecovery::confirm(bool found, bool was_lost, int inliers) {
  if (found && was_lost) found_time_ = context_.current.timestamp;
  if (!context_.features_have_depth || context_.localises_only || may_return()) return;
  const bool is_ample = local_map_.checks().has_ample_inliers(inliers);
  if (!found) {
    withdraw();
  } else if (was_lost && !is_ample && !context_.history.empty()) {
    unconfirmed_ = {context_.history.mark()};
  } else if (unconfirmed_ && (is_ample || ++unconfirmed_->frames >= context_.settings.confirming_frames)) {
    unconfirmed_.reset();
  }
}

void LossRecovery::withdraw() {
  if (!unconfirmed_) return;
  withdrawn_ += context_.history.return_to(unconfirmed_->before);
  unconfirmed_.reset();
}

bool LossRecovery::was_just_found() const {
  return found_time_ && context_.current.timestamp - *found_time_ < context_.settings.found_time;
}

bool LossRecovery::wants_mask(TrackerState state) const {
  return !context_.localises_only && !context_.history.empty() &&
         (state == TrackerState::lost || state == TrackerState::unconfirmed);
}

void LossRecovery::finish(StageTimes& times, const std::atomic<bool>& stop) {
  withdraw();
  backwards_.finish(times);
  late_.finish(times, stop);
}

LossRecord LossRecovery::record() const {
  return {.tracked_backwards = backwards_.tracked(),
          .located_late = late_.located(),
          .withdrawn = withdrawn_ + backwards_.withdrawn(),
          .submaps = submaps_,
          .left_out = context_.history.frames_left_out(context_.map)};
}

}  // namespace holdfast
