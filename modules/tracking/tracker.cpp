// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/tracker.hpp"

#include <algorithm>
#include <utility>

namespace holdfast {

Tracker::Tracker(const TrackingSettings& settings, const Camera& camera, FeatureExtractor& extractor,
                 Optimizer& optimizer, FilterChain& filters, const LoopDetector& detector, Map& map, std::uint64_t seed)
    : settings_(settings),
      builder_(camera, extractor, settings.depth_edge_ratio),
      optimizer_(optimizer),
      filters_(filters),
      detector_(detector),
      map_(map),
      random_(Random(seed).fork(1)),
      state_(map.keyframes().empty() ? State::waiting : State::lost),
      local_map_(settings.local_keyframes) {}

void Tracker::begin(const SensorFrame& sensor_frame, FrameResult& result) {
  result.index = sensor_frame.index;
  result.timestamp = sensor_frame.timestamp;
  std::swap(current_, previous_);
  builder_.begin(sensor_frame, current_, result.times);
  cv::Mat moving;
  if (propagator_) {
    const StageTimer timer(result.times, "masks");
    propagator_->advance(builder_.grey(), current_, predicted_step());
    current_.coarse.labels = propagator_->mask().labels;
    if (filters_.settings().skip_moving) moving = propagator_->moving_pixels();
  }
  builder_.find_features(sensor_frame, moving, current_, result.times);
  result.features = static_cast<int>(current_.size());
}

void Tracker::locate(const SensorFrame& sensor_frame, FrameResult& result) {
  if (state_ == State::waiting) {
    if (start_map(result)) {
      state_ = State::tracking;
      result.status = TrackingStatus::initialised;
    }
    remember(result);
    return;
  }
  bool found = false;
  if (has_previous_) previous_.T_camera_world = T_previous_reference_ * map_.pose_of(reference_keyframe_);
  filters_.begin(current_);
  judge(FilterChain::Stage::before_matching, sensor_frame, result);
  if (state_ == State::tracking) {
    const StageTimer timer(result.times, "predict");
    found = predict_with_velocity(result) || predict_with_keyframe(reference_keyframe_, result);
  }
  if (!found) {
    const StageTimer timer(result.times, "relocalisation");
    found = coast(result) || recover(result) || relocalise(result);
  }
  if (found) judge_with_pose(sensor_frame, result);
  found = found && track_local_map(sensor_frame, result);
  state_ = found ? State::tracking : State::lost;
  result.status = found ? TrackingStatus::tracked : TrackingStatus::lost;
  if (found) {
    const StageTimer timer(result.times, "keyframe");
    result.is_keyframe = !localises_only_ && needs_keyframe(result);
    result.trouble = TrackingTrouble::none;
    result.objects = filters_.evidence().objects();
    if (result.is_keyframe) local_map_.write_counts(map_);  // local mapping judges points by them
  }
  remember(result);
}

bool Tracker::start_map(FrameResult& result) {
  int with_depth = 0;
  for (std::size_t i = 0; i < current_.size(); ++i) with_depth += current_.has_depth(i) ? 1 : 0;
  if (with_depth < settings_.minimum_start_points) {
    result.trouble =
        result.features < settings_.minimum_start_points ? TrackingTrouble::few_features : TrackingTrouble::no_depth;
    return false;
  }
  current_.T_camera_world.setIdentity();
  result.is_keyframe = true;
  result.inliers = 0;
  return true;
}

int Tracker::match_local_map(float window) {
  local_map_.update(map_, current_, map_.version());
  windows_.clear();
  local_map_.project(current_, window, windows_);
  MatchRule rule;
  rule.maximum_distance = settings_.possible_distance;
  rule.ratio = static_cast<float>(settings_.descriptor_ratio);
  for (const ProjectionMatch& match : search_.match(windows_, local_map_.descriptors().data(), current_, rule))
    current_.map_points[match.feature] = local_map_.points()[match.source];
  return adjust_pose();
}

FilterContext Tracker::filter_context(const SensorFrame& sensor_frame, const Eigen::Isometry3d* T_camera_world) const {
  const bool has_mask = propagator_ && !propagator_->mask().empty();
  return {.sensor_frame = sensor_frame,
          .frame = current_,
          .previous = has_previous_ ? &previous_ : nullptr,
          .map = map_,
          .T_camera_world = T_camera_world,
          .carried_mask = has_mask ? &propagator_->mask() : nullptr,
          .classes = classes_,
          .movable = &movable_};
}

void Tracker::judge(FilterChain::Stage stage, const SensorFrame& sensor_frame, FrameResult& result) {
  if (!filters_.has(stage)) return;
  const StageTimer timer(result.times, "filters");
  const bool has_pose = stage != FilterChain::Stage::before_matching;
  filters_.judge(stage, filter_context(sensor_frame, has_pose ? &current_.T_camera_world : nullptr));
}

void Tracker::judge_with_pose(const SensorFrame& sensor_frame, FrameResult& result) {
  if (!filters_.has(FilterChain::Stage::with_pose)) return;
  {
    // When movers led the matches astray, the camera is rather where its velocity takes it.
    const StageTimer timer(result.times, "filters");
    if (has_previous_ && has_velocity_ && depth_agreement_.choose(map_, reference_keyframe_, current_.timestamp)) {
      constexpr double clear_lead = 0.03;
      const Eigen::Isometry3d predicted = predicted_step() * previous_.T_camera_world;
      if (depth_agreement_.share(current_, predicted) >
          depth_agreement_.share(current_, current_.T_camera_world) + clear_lead)
        current_.T_camera_world = predicted;
      current_.coarse.T_view_camera = depth_agreement_.find_view(current_, current_.T_camera_world,
                                                                 current_.T_camera_world * previous_.T_world_camera());
    }
  }
  judge(FilterChain::Stage::with_pose, sensor_frame, result);
  const Eigen::Isometry3d judged_with = current_.T_camera_world;
  if (adjust_pose() < settings_.minimum_matches / 2) current_.T_camera_world = judged_with;
  drop_outliers();
}

int Tracker::judge_after_matching(const SensorFrame& sensor_frame, int inliers, FrameResult& result) {
  if (!filters_.has(FilterChain::Stage::after_matching)) return inliers;
  judge(FilterChain::Stage::after_matching, sensor_frame, result);
  return adjust_pose();
}

bool Tracker::track_local_map(const SensorFrame& sensor_frame, FrameResult& result) {
  {
    const StageTimer timer(result.times, "local map");
    result.inliers = match_local_map(static_cast<float>(settings_.local_map_window));
  }
  if (result.inliers >= settings_.minimum_inliers)
    result.inliers = judge_after_matching(sensor_frame, result.inliers, result);
  const StageTimer timer(result.times, "local map");
  filters_.carry(current_, map_);
  result.matches = static_cast<int>(problem_.size());
  result.static_features = static_cast<int>(std::count_if(
      current_.static_probability.begin(), current_.static_probability.end(), [](float p) { return p >= 0.5F; }));
  drop_outliers();
  local_map_.count_found(current_);
  if (result.inliers < settings_.minimum_inliers || pose_deviation_ > settings_.maximum_deviation ||
      contradicts_depth(result)) {
    result.trouble = TrackingTrouble::few_inliers;
    return false;
  }
  reference_keyframe_ = local_map_.reference_keyframe();
  return true;
}

bool Tracker::contradicts_depth(const FrameResult& result) {
  // Few inliers may agree by chance, above all when a lost camera tries many poses among people who fill the view. The
  // room itself, where it shows at all, does not.
  const bool was_lost = result.method == TrackingMethod::recovered || result.method == TrackingMethod::relocalised;
  if (filters_.empty() || result.inliers >= (was_lost ? 60 : 50)) return false;
  if (!depth_agreement_.choose(map_, reference_keyframe_, current_.timestamp)) return false;
  const Eigen::Isometry3d T_view_world = current_.coarse.T_view_camera * current_.T_camera_world;
  return depth_agreement_.share(current_, T_view_world) < (was_lost ? 0.08 : 0.05);
}

bool Tracker::needs_keyframe(const FrameResult& result) const {
  const double since_last = current_.timestamp - last_keyframe_time_;
  if (result.inliers < settings_.minimum_inliers) return false;

  // Points that the reference keyframe shares with the established map.
  const Frame& reference = map_.keyframe(reference_keyframe_).frame;
  const std::size_t enough_observations = map_.keyframes().size() <= 2 ? 1 : 2;
  int reference_points = 0;
  for (const MapPointId id : reference.map_points)
    if (const MapPoint* point = map_.find_point(id); point && point->observations.size() >= enough_observations)
      ++reference_points;

  int close_tracked = 0, close_possible = 0;
  const float close = static_cast<float>(settings_.close_depth_factor * current_.camera->baseline);
  for (std::size_t i = 0; i < current_.size(); ++i) {
    if (!current_.has_depth(i) || current_.depth[i] > close) continue;
    ++(current_.map_points[i].valid() ? close_tracked : close_possible);
  }
  const bool wants_close =
      close_tracked < settings_.keyframe_close_tracked && close_possible > settings_.keyframe_close_possible;
  const double ratio =
      map_.keyframes().size() < 2 ? std::min(0.4, settings_.keyframe_tracked_ratio) : settings_.keyframe_tracked_ratio;
  if (holds_keyframes_ || since_last < settings_.keyframe_minimum_interval)
    return result.inliers < 2 * settings_.minimum_inliers;
  const bool weak = result.inliers < ratio * reference_points;
  const bool due = since_last >= settings_.keyframe_maximum_interval;
  if (propagator_ && propagator_->mask().age >= settings_.keyframe_mask_age) return true;
  return wants_close || weak || (due && result.inliers < 0.9 * reference_points);
}

void Tracker::keyframe_added(KeyFrameId keyframe) {
  const Frame& stored = map_.keyframe(keyframe).frame;
  current_.map_points = stored.map_points;
  current_.T_camera_world = stored.T_camera_world;
  reference_keyframe_ = last_keyframe_ = keyframe;
  last_keyframe_time_ = current_.timestamp;
  T_previous_reference_.setIdentity();
  if (!records_.empty() && records_.back().timestamp == current_.timestamp)
    records_.back() = {current_.timestamp, keyframe, Eigen::Isometry3d::Identity()};
}

void Tracker::expect_masks(const Segmenter& segmenter, double memory) {
  classes_ = &segmenter.classes();
  movable_ = segmenter.movable();
  propagator_.emplace(*builder_.camera(), builder_.coarse_sampler(), memory);
}

void Tracker::await_mask() {
  if (propagator_) propagator_->remember();
}

void Tracker::mask_came(std::uint64_t frame_index, const Segmentation& segmentation) {
  if (propagator_) propagator_->apply(frame_index, segmentation);
}

void Tracker::judge_keyframe(const SensorFrame& sensor_frame, const Segmentation& segmentation, KeyFrameId id) {
  KeyFrame* keyframe = map_.find_keyframe(id);
  if (keyframe == nullptr || segmentation.empty()) return;
  CarriedMask mask;
  sample_segmentation(builder_.coarse_sampler(), segmentation, mask.labels, mask.confidence);
  keyframe->frame.coarse.labels = mask.labels;
  filters_.judge_segmented({.sensor_frame = sensor_frame,
                            .frame = keyframe->frame,
                            .map = map_,
                            .T_camera_world = &keyframe->frame.T_camera_world,
                            .segmentation = &segmentation,
                            .carried_mask = &mask,
                            .classes = classes_,
                            .movable = &movable_},
                           keyframe->frame);
}

void Tracker::remember(FrameResult& result) {
  if (propagator_)
    propagator_->located(result.status == TrackingStatus::lost || result.status == TrackingStatus::waiting
                             ? std::nullopt
                             : std::optional(current_.T_camera_world),
                         current_.coarse, -static_cast<float>(filters_.settings().static_log_odds) - 1.0F);
  const bool has_pose = result.status == TrackingStatus::initialised || result.status == TrackingStatus::tracked;
  if (!has_pose) {
    has_previous_ = has_velocity_ = false;
    return;
  }
  coasts_until_ = current_.timestamp + settings_.coasting_time;
  result.T_world_camera = current_.T_world_camera();
  if (has_previous_) {
    velocity_ = current_.T_camera_world * previous_.T_world_camera();
    velocity_interval_ = current_.timestamp - previous_.timestamp;
    has_velocity_ = true;
  }
  has_previous_ = true;
  if (reference_keyframe_.valid()) {
    result.keyframe = reference_keyframe_;
    T_previous_reference_ = current_.T_camera_world * map_.pose_of(reference_keyframe_).inverse();
  }
  records_.push_back({current_.timestamp, reference_keyframe_, T_previous_reference_});
}

Trajectory Tracker::trajectory() const {
  Trajectory trajectory;
  trajectory.reserve(records_.size());
  for (const Record& record : records_)
    trajectory.push_back({record.timestamp, (record.T_camera_reference * map_.pose_of(record.reference)).inverse()});
  return trajectory;
}

}  // namespace holdfast
