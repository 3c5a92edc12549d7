// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/pose_checks.hpp"

#include "holdfast/core/after_loss.hpp"
#include "holdfast/tracking/inertia.hpp"

namespace holdfast {

namespace {
/// Of the limit for a contradiction of inertia, where ample inliers determine the pose.
constexpr double ample_factor = 2.0;
}  // namespace

bool PoseChecks::has_ample_inliers(int inliers) const {
  return inliers >= context_.settings.ample_inliers * context_.settings.minimum_inliers;
}

bool PoseChecks::contradicts_motion(int inliers) const {
  // Two groups of features move rigidly where a person fills much of the view, and the person's may be the larger one.
  // A camera has inertia: from one frame to the next, its velocity changes by little.
  return !has_ample_inliers(inliers) && exceeds_acceleration(1.0);
}

bool PoseChecks::contradicts_measured_motion(int inliers) const {
  return context_.inertia.contradicts(context_.current.T_camera_world, has_ample_inliers(inliers) ? ample_factor : 1.0);
}

bool PoseChecks::exceeds_acceleration(double factor) const {
  const FrameHistory& history = context_.history;
  if (!history.has_previous() || !history.has_velocity()) return false;
  const std::optional<double> interval = context_.interval();
  return interval && contradicts_inertia(context_.current.T_camera_world * context_.predicted_pose().inverse(),
                                         *interval, context_.settings, factor);
}

/// Whether the map of one camera explains next to nothing of the static features, as where a person whom no mask shows
/// fills the view. New points would fit any scale that such a pose goes on with.
bool PoseChecks::lacks_support(const FrameResult& result, double map_age) const {
  const TrackingSettings& settings = context_.settings;
  return !context_.features_have_depth && map_age > settings.support_age &&
         result.inliers < settings.minimum_support * result.static_features;
}

bool PoseChecks::is_refuted(int inliers, bool was_lost) const {
  return (!was_lost && (contradicts_motion(inliers) || contradicts_measured_motion(inliers))) ||
         context_.estimator.position_deviation() > context_.settings.maximum_deviation ||
         context_.moving_world.contradicts_depth(context_.current, inliers, was_lost, context_.reference_keyframe);
}

bool PoseChecks::accepts(const FrameResult& result, const PoseSituation& situation) const {
  const bool was_lost = is_after_loss(result.method);
  // A wide search finds some agreement anywhere: twice as many have to agree.
  const int required = (was_lost ? 2 : 1) * context_.settings.minimum_inliers;
  if (result.inliers < required) return false;
  if (!was_lost && has_ample_inliers(result.inliers))
    context_.inertia.count_refusal(context_.current.T_camera_world, ample_factor);
  // With few inliers the support may be a person, so a relocalised pose must be reachable from the last one.
  const bool may_be_anywhere = has_ample_inliers(result.inliers) || situation.may_be_anywhere;
  if (was_lost && !context_.relocaliser.is_beyond_chance(result.inliers)) return false;
  if (was_lost && !may_be_anywhere && !context_.relocaliser.is_reachable(context_.current, 0.0)) return false;
  // Few disparities, or far ones, agree with a wrong pose as well.
  constexpr double certain = 0.5;
  if (was_lost && context_.map.sensor() == Sensor::stereo &&
      context_.estimator.position_deviation() > certain * context_.settings.maximum_deviation)
    return false;
  if (was_lost && !has_ample_inliers(result.inliers) && contradicts_measured_motion(result.inliers)) return false;
  return !lacks_support(result, situation.map_age) && !is_refuted(result.inliers, was_lost);
}

}  // namespace holdfast
