// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/mapping/pair_calibrator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "holdfast/interfaces/frame_observations.hpp"
#include "holdfast/matching/point_block.hpp"
#include "pair_bundle.hpp"

namespace holdfast {

namespace {

/// Corrects the disparities of a frame by other errors than before. A point beyond infinity loses its depth.
void correct_frame(const PairErrors& before, const PairErrors& now, Frame& frame) {
  const Camera& camera = *frame.camera;
  const double fx_baseline = camera.fx * camera.baseline;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (std::isnan(frame.right_x[i])) continue;
    const double y = frame.y[i], right_x = frame.right_x[i];
    const double disparity = frame.x[i] - right_x + now.column(camera, right_x, y) - before.column(camera, right_x, y);
    if (disparity > 0.0) {
      frame.depth[i] = static_cast<float>(fx_baseline / disparity);
      frame.right_x[i] = static_cast<float>(frame.x[i] - disparity);
    } else {
      frame.depth[i] = 0.0F;
      frame.right_x[i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

/// The observations of points by at least three keyframes of a window.
BundleProblem problem_of(const Map& map, const std::vector<KeyFrameId>& keyframes) {
  constexpr std::size_t minimum_views = 3;
  BundleProblem problem;
  problem.camera = map.keyframe(keyframes.front()).frame.camera.get();
  std::vector<std::int32_t> pose_of_slot(map.keyframes().slot_count(), -1);
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    problem.poses.push_back({map.keyframe(keyframes[i]).frame.T_camera_world, i == 0});
    pose_of_slot[keyframes[i].slot] = static_cast<std::int32_t>(i);
  }
  for (const MapPointId id : points_seen_by(map, keyframes)) {
    const MapPoint& point = map.point(id);
    if (point.observations.size() < minimum_views) continue;
    const std::size_t begin = problem.observations.size();
    for (const Observation& observation : point.observations) {
      const std::int32_t pose = pose_of_slot[observation.keyframe.slot];
      if (pose < 0) continue;
      problem.observations.push_back(bundle_observation(map.keyframe(observation.keyframe).frame, observation.feature,
                                                        static_cast<std::uint32_t>(pose),
                                                        static_cast<std::uint32_t>(problem.points.size())));
    }
    if (problem.observations.size() - begin < minimum_views)
      problem.observations.resize(begin);
    else
      problem.points.push_back(point.position);
  }
  return problem;
}

}  // namespace

PairCalibrator::PairCalibrator(Map& map, MapMutex& mutex, StereoCalibration& calibration)
    : map_(map), mutex_(mutex), calibration_(calibration), bundle_(std::make_unique<PairBundle>()) {}
PairCalibrator::~PairCalibrator() = default;

void PairCalibrator::add(const MapAccess&, KeyFrameId keyframe) {
  corrected_by_.emplace_back(keyframe, calibration_.errors_of_frame());
}

bool PairCalibrator::correct(const MapAccess& map) {
  const PairErrors now = corrected_ = calibration_.errors();
  bool has_changed = false;
  std::erase_if(corrected_by_, [&](const auto& entry) { return map->find_keyframe(entry.first) == nullptr; });
  for (auto& [keyframe, errors] : corrected_by_) {
    if (errors == now) continue;
    correct_frame(errors, now, map->keyframe(keyframe).frame);
    errors = now;
    has_changed = true;
  }
  return has_changed;
}

void PairCalibrator::learn(KeyFrameId keyframe) {
  constexpr std::size_t minimum_keyframes = 4, complete = 12;
  if (!calibration_.is_estimated()) return;
  BundleProblem problem;
  {
    const std::lock_guard lock(mutex_);
    std::erase_if(window_, [&](KeyFrameId id) { return map_.find_keyframe(id) == nullptr; });
    if (std::find(window_.begin(), window_.end(), keyframe) != window_.end()) return;
    window_.push_back(keyframe);
    if (window_.size() < minimum_keyframes) return;
    problem = problem_of(map_, window_);
  }
  const std::optional<ColumnEstimate> estimate = bundle_->solve(problem);
  const bool is_complete = window_.size() >= complete;
  if (estimate) calibration_.learn_columns(*estimate, corrected_, is_complete);
  if (is_complete) window_ = {keyframe};
}

}  // namespace holdfast
