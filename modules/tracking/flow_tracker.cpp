// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/flow_tracker.hpp"

#include <algorithm>
#include <vector>

namespace holdfast {

bool FlowTracker::follow(const SensorFrame& sensor_frame, const cv::Mat& ignored, bool is_tracking,
                         FrameResult& result) {
  const FrameHistory& history = context_.history;
  {
    const StageTimer timer(result.times, "flow");
    flow_.add_image(context_.builder.grey());
    if (!is_tracking || !history.has_previous() || !history.has_velocity()) {
      flow_.clear();
      return false;
    }
    if (frames_ == 0) flow_.set_template(context_.previous);
    if (frames_ >= context_.settings.flow_frames) return false;
    if (!flow_.follow(context_.predicted_pose(), ignored, context_.current.features)) return false;
    const auto required = context_.settings.flow_share * static_cast<double>(flow_.size());
    if (static_cast<double>(context_.current.features.size()) < required) return false;
  }
  ++frames_;
  context_.builder.complete(sensor_frame, context_.current, result.times);
  context_.place_features(sensor_frame, context_.predicted_step(), result.times);
  result.features = static_cast<int>(context_.current.size());
  return true;
}

bool FlowTracker::track(TrackedView& view, FrameResult& result) {
  Frame& frame = context_.current;
  MovingWorld& moving_world = context_.moving_world;
  const double required = std::max<double>(context_.settings.minimum_inliers,
                                           context_.settings.flow_share * static_cast<double>(flow_.size()));
  moving_world.evaluate(FilterStage::before_matching, view, result.times);
  {
    const StageTimer timer(result.times, "predict");
    const std::vector<MapPointId>& points = flow_.found_points();
    for (std::size_t i = 0; i < points.size(); ++i)
      frame.map_points[i] = context_.map.find_point(points[i]) == nullptr ? MapPointId() : points[i];
    frame.T_camera_world = context_.predicted_pose();
    if (context_.estimator.adjust(frame) < required) return false;
    context_.estimator.drop_outliers(frame);
  }
  context_.place_features(view.sensor_frame, context_.measured_step(), result.times);
  local_map_.evaluate_with_pose(view, result);
  moving_world.evaluate(FilterStage::after_matching, view, result.times);
  const StageTimer timer(result.times, "local map");
  result.inliers = context_.estimator.adjust(frame);
  local_map_.count_matches(result);
  context_.estimator.drop_outliers(frame);
  if (result.inliers < required || local_map_.checks().is_refuted(result.inliers, false) || keyframes_.is_due(result))
    return false;
  result.method = TrackingMethod::flow;
  result.covariance = context_.estimator.covariance();
  moving_world.accumulate(frame);
  return true;
}

void FlowTracker::forget() {
  flow_.clear();
  frames_ = 0;
}

}  // namespace holdfast
