// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "holdfast/geometry/se3.hpp"
#include "holdfast/matching/frame_features.hpp"
#include "holdfast/tracking/inertia.hpp"

namespace holdfast {

namespace {

/// Times minimum_inliers: so many features that agree with a pose need no other support.
constexpr int sure_inliers = 4;

/// How long the map of one camera takes to settle after its start, which is judged then [s].
constexpr double settling_time = 0.5;

}  // namespace

Tracker::Tracker(const TrackingSettings& settings, const TrackerParts& parts)
    : settings_(settings),
      moving_world_(parts.moving_world),
      map_(parts.map),
      builder_(parts.camera, parts.features, settings.depth_edge_ratio),
      matcher_(settings, parts.map, parts.matcher),
      estimator_(parts.optimizer, parts.moving_world, parts.map),
      relocaliser_(settings, {parts.detector, parts.moving_world, parts.map, matcher_, estimator_, history_},
                   parts.seed),
      backwards_(settings_, {parts.map, parts.moving_world, matcher_, estimator_, history_}),
      keyframe_policy_(settings),
      shutter_(parts.stereo ? RollingShutterMode::off : settings.rolling_shutter, parts.camera.readout),
      state_(parts.map.keyframes().empty() ? State::waiting : State::lost) {
  if (parts.stereo) builder_.use_stereo(*parts.stereo);
  if (settings.between_keyframes == BetweenKeyframes::flow) flow_.emplace();
  start_is_judged_ = !parts.has_depth || settings.start_share <= 0.0 || !parts.map.keyframes().empty();
  if (!parts.has_depth) mono_.emplace(settings, parts.optimizer, parts.seed, parts.matcher);
}

void Tracker::begin(const SensorFrame& sensor_frame, FrameResult& result) {
  result.index = sensor_frame.index;
  result.timestamp = sensor_frame.timestamp;
  std::swap(current_, previous_);
  builder_.begin(sensor_frame, current_, result.times);
  ignored_ =
      moving_world_.begin_frame(builder_.grey(), history_.predicted_step(current_.timestamp), current_, result.times);
  if (!flow_ || !follow_features(sensor_frame, result)) find_features(sensor_frame, result);
}

void Tracker::find_features(const SensorFrame& sensor_frame, FrameResult& result) {
  followed_frames_ = 0;
  builder_.set_budget(feature_budget());
  builder_.find_features(sensor_frame, ignored_, current_, result.times);
  if (history_.has_velocity()) place_features(sensor_frame, history_.predicted_step(current_.timestamp), result.times);
  result.features = static_cast<int>(current_.size());
}

double Tracker::feature_budget() const {
  if (state_ == State::waiting || previous_.size() == 0) return 1.0;
  const auto& probability = previous_.static_probability;
  const auto kept = std::count_if(probability.begin(), probability.end(), [](float p) { return is_static(p); });
  const double share = static_cast<double>(kept) / static_cast<double>(previous_.size());
  return std::clamp(settings_.crowd_share / std::max(share, 1e-3), 1.0, settings_.crowd_features);
}

bool Tracker::follow_features(const SensorFrame& sensor_frame, FrameResult& result) {
  {
    const StageTimer timer(result.times, "flow");
    flow_->add_image(builder_.grey());
    if (state_ != State::tracking || !history_.has_previous() || !history_.has_velocity()) {
      flow_->clear();
      return false;
    }
    if (followed_frames_ == 0) flow_->set_template(previous_);
    if (followed_frames_ >= settings_.flow_frames) return false;
    const Eigen::Isometry3d predicted = history_.predicted_step(current_.timestamp) * previous_.T_camera_world;
    if (!flow_->follow(predicted, ignored_, current_.features)) return false;
    const auto required = settings_.flow_share * static_cast<double>(flow_->size());
    if (static_cast<double>(current_.features.size()) < required) return false;
  }
  ++followed_frames_;
  builder_.complete(sensor_frame, current_, result.times);
  place_features(sensor_frame, history_.predicted_step(current_.timestamp), result.times);
  result.features = static_cast<int>(current_.size());
  return true;
}

void Tracker::locate(const SensorFrame& sensor_frame, FrameResult& result) {
  begins_with_two_views_ = gave_map_up_ = begins_piece_ = false;
  if (state_ == State::waiting) {
    if (mono_)
      start_with_two_views(sensor_frame, result);
    else
      start_with_depth(sensor_frame, result);
    end_frame(result);
    return;
  }
  if (history_.has_previous()) previous_.T_camera_world = history_.last_pose(map_);
  TrackedView view{sensor_frame, history_.has_previous() ? &previous_ : nullptr, current_, piece()};
  odometry_extends_map_ = false;
  bool found = followed_frames_ > 0 && track_followed(view, result);
  if (followed_frames_ > 0 && !found) find_features(sensor_frame, result);
  if (!found) {
    moving_world_.evaluate(FilterStage::before_matching, view, result.times);
    found = find_pose(view, result);
  }
  if (mono_) {
    const bool is_weak = found && is_weak_start(result);
    if (is_weak) result.trouble = TrackingTrouble::weak_start;
    gave_map_up_ = is_weak || (!found && was_lost_at_start());
    found = found && !is_weak;
  } else if (!found && was_lost_at_start() && start_map(coasting_pose(current_.timestamp), result)) {
    begins_piece_ = piece() != 0;  // the first piece goes on, since frames may follow it that were tracked before
    end_frame(result);
    return;
  } else if (!found && should_begin_piece() && start_map(coasting_pose(current_.timestamp), result)) {
    begins_piece_ = true;
    if (!left_reference_.valid()) left_keyframe_ = last_keyframe_, left_reference_ = reference_keyframe_;
    end_frame(result);
    return;
  }
  if (found && left_reference_.valid()) return_from_piece(view, result);
  confirm_recovery(found, result.inliers);
  if (found && state_ == State::lost) found_time_ = current_.timestamp;
  state_ = found ? State::tracking : State::lost;
  result.status = found ? TrackingStatus::tracked : TrackingStatus::lost;
  if (found) {
    const StageTimer timer(result.times, "keyframe");
    const bool on_map = result.inliers >= settings_.minimum_inliers;
    if (on_map && history_.has_previous())
      if (const auto motion = motion_by(current_.T_camera_world * previous_.T_world_camera()))
        shutter_.learn(*motion, map_, current_);
    result.is_keyframe = !localises_only_ && !unconfirmed_ && followed_frames_ == 0 &&
                         (on_map ? needs_keyframe(result) : odometry_extends_map_);
    if (on_map || result.is_keyframe) last_feature_time_ = current_.timestamp;
    result.trouble = TrackingTrouble::none;
    result.objects = moving_world_.objects();
    if (result.is_keyframe) matcher_.local_map().write_counts(map_);  // local mapping evaluates points by them
  }
  end_frame(result);
}

void Tracker::confirm_recovery(bool found, int inliers) {
  if (mono_ || localises_only_ || left_reference_.valid()) return;
  constexpr int sure_frames = 8;  // in a row
  if (!found) {
    withdraw_recovery();
  } else if (state_ == State::lost && !is_sure(inliers) && !history_.empty()) {
    unconfirmed_ = {history_.mark()};
  } else if (unconfirmed_ && (is_sure(inliers) || ++unconfirmed_->frames >= sure_frames)) {
    unconfirmed_.reset();
  }
}

void Tracker::withdraw_recovery() {
  if (!unconfirmed_) return;
  withdrawn_ += history_.return_to(unconfirmed_->before);
  unconfirmed_.reset();
}

void Tracker::finish(StageTimes& times) {
  withdraw_recovery();
  backwards_.finish(times);
}

std::optional<FrameMotion> Tracker::motion_by(const Eigen::Isometry3d& step) const {
  constexpr double max_interval = 0.2;  // s; over a longer one the velocity may have changed
  const double interval = current_.timestamp - history_.last_timestamp();
  if (interval > max_interval) return std::nullopt;
  return FrameMotion{geometry::log_se3(step), interval};
}

void Tracker::place_features(const SensorFrame& sensor_frame, const Eigen::Isometry3d& step, StageTimes& times) {
  constexpr double min_delay = 1e-4;  // s
  const bool aligns_depth = settings_.depth_alignment && std::abs(sensor_frame.depth_delay) >= min_delay;
  if (const std::optional<FrameMotion> motion = motion_by(step))
    builder_.place_features(sensor_frame, *motion, aligns_depth, shutter_, map_, current_, times);
}

bool Tracker::was_lost_at_start() const {
  if (localises_only_ || history_.empty()) return false;
  // The next frames or a mask that is on its way may help; the longer the map has been tracked by, the longer it is
  // worth waiting for a view of it.
  constexpr double min_patience = 0.1, patience_share = 0.5;  // s; share of the map's age
  const double age = history_.last_timestamp() - map_start_time_;
  const double lost_for = current_.timestamp - history_.last_timestamp();
  return age < settings_.young_map_time && lost_for > std::max(min_patience, patience_share * age);
}

bool Tracker::should_begin_piece() {
  if (localises_only_ || history_.empty() || settings_.restart_time <= 0.0) return false;
  if (current_.timestamp - history_.last_timestamp() <= settings_.restart_time) return false;
  // A piece that began on people would never fit the rest.
  if (moving_world_.expects_masks() &&
      (!moving_world_.has_mask() || moving_world_.mask_age() > settings_.keyframe_mask_age))
    return false;
  return can_begin_among_people();
}

LossRecord Tracker::loss_record() const {
  return {.tracked_backwards = backwards_.tracked(),
          .withdrawn = withdrawn_ + backwards_.withdrawn(),
          .pieces = pieces_,
          .left_out = history_.frames_left_out(map_)};
}

bool Tracker::needs_mask() const {
  return !localises_only_ && !mono_ && (state_ == State::lost || unconfirmed_) && !history_.empty();
}

bool Tracker::was_just_found() const {
  constexpr double recent = 0.5;  // s; until a mask made since then has arrived
  return found_time_ && current_.timestamp - *found_time_ < recent;
}

Eigen::Isometry3d Tracker::predicted_pose() const {
  return history_.predicted_step(current_.timestamp) * previous_.T_camera_world;
}

Eigen::Isometry3d Tracker::coasting_pose(double timestamp) const {
  const bool coasts = timestamp <= history_.last_timestamp() + settings_.coasting_time;
  return history_.extrapolate(timestamp, coasts ? 1.0 : 0.0) * history_.last_pose(map_);
}

bool Tracker::start_map(const Eigen::Isometry3d& T_camera_world, FrameResult& result) {
  if (builder_.is_pair_exchanged(current_)) {
    result.trouble = TrackingTrouble::exchanged_pair;
    return false;
  }
  int with_depth = 0;
  for (std::size_t i = 0; i < current_.size(); ++i) with_depth += current_.has_depth(i) ? 1 : 0;
  if (with_depth < settings_.minimum_start_points) {
    result.trouble =
        result.features < settings_.minimum_start_points ? TrackingTrouble::few_features : TrackingTrouble::no_depth;
    return false;
  }
  current_.T_camera_world = T_camera_world;
  std::fill(current_.map_points.begin(), current_.map_points.end(), MapPointId());
  begin_map(result);
  return true;
}

void Tracker::start_with_depth(const SensorFrame& sensor_frame, FrameResult& result) {
  if (moving_world_.has_mask()) {
    moving_world_.evaluate(FilterStage::before_matching, {sensor_frame, nullptr, current_}, result.times);
    if (!can_begin_among_people()) {
      result.trouble = TrackingTrouble::few_features;
      return;
    }
  }
  start_map(Eigen::Isometry3d::Identity(), result);
}

bool Tracker::can_begin_among_people() {
  moving_world_.weight_features(current_);
  int usable = 0;
  for (std::size_t i = 0; i < current_.size(); ++i) usable += current_.has_depth(i) && is_static(current_, i) ? 1 : 0;
  return usable >= settings_.minimum_start_points;
}

bool Tracker::is_start_refuted() {
  if (start_is_judged_ || !moving_world_.has_mask()) return false;
  start_is_judged_ = true;
  if (localises_only_ || map_.keyframes().empty()) return false;
  const Frame& first = map_.keyframe(map_.keyframes_by_age().front()).frame;
  int kept = 0, usable = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (!is_static(first, i)) continue;
    ++kept;
    usable += first.has_depth(i) ? 1 : 0;
  }
  // Where little is left to begin with, a map that is wrong in part is better than none.
  if (kept < settings_.start_share * static_cast<double>(first.size()) && usable >= settings_.minimum_start_points)
    return true;
  backwards_.clear();
  return false;
}

void Tracker::start_with_two_views(const SensorFrame& sensor_frame, FrameResult& result) {
  if (moving_world_.expects_masks() && !moving_world_.has_mask()) {
    result.trouble = TrackingTrouble::no_mask;
    return;
  }
  const TrackedView view{sensor_frame, nullptr, current_};
  moving_world_.evaluate(FilterStage::before_matching, view, result.times);
  moving_world_.weight_features(current_);
  const StageTimer timer(result.times, "initialisation");
  result.trouble = mono_->add(current_);
  if (result.trouble != TrackingTrouble::none) return;
  begins_with_two_views_ = true;
  begin_map(result);
  result.inliers = static_cast<int>(mono_->start().points.size());
}

bool Tracker::is_weak_start(const FrameResult& result) {
  constexpr double first_age = 0.3, last_age = settling_time;  // s; before, a right map is small too
  const double age = current_.timestamp - map_start_time_;
  if (age >= first_age && age <= last_age && result.matches > 0) {
    // How many of the static features are in the map, times how many of those agree with the pose.
    const double inliers = result.inliers, found = result.matches, seen = std::max(result.static_features, 1);
    start_support_ += inliers / seen * inliers / found;
    ++start_frames_;
  }
  if (age <= last_age || start_frames_ == 0) return false;
  const double support = start_support_ / start_frames_;
  start_frames_ = 0;
  start_support_ = 0.0;
  // A place without texture may offer no better start: each further one needs half as much.
  if (support >= std::ldexp(settings_.start_support, -weak_starts_)) return false;
  ++weak_starts_;
  return true;
}

void Tracker::forget_map() {
  history_.clear();
  if (mono_) mono_->forget();
  if (flow_) flow_->clear();
  followed_frames_ = 0;
  state_ = State::waiting;
  unconfirmed_.reset();
  reference_keyframe_ = last_keyframe_ = KeyFrameId();
  last_keyframe_time_ = last_feature_time_ = 0.0;
  gave_map_up_ = false;
}

void Tracker::map_begun(KeyFrameId reference, const std::vector<MapPointId>& points) {
  const TwoViewStart& start = mono_->start();
  for (std::size_t i = 0; i < points.size(); ++i) current_.map_points[start.points[i].in_frame] = points[i];
  history_.add_before_last(reference, start.reference.timestamp);
}

void Tracker::begin_map(FrameResult& result) {
  unconfirmed_.reset();
  start_support_ = 0.0;
  start_frames_ = 0;
  map_start_time_ = last_feature_time_ = current_.timestamp;
  state_ = State::tracking;
  result.status = TrackingStatus::initialised;
  result.method = TrackingMethod::none;
  result.trouble = TrackingTrouble::none;
  result.is_keyframe = true;
  result.inliers = 0;
}

bool Tracker::find_pose(TrackedView& view, FrameResult& result) {
  if (state_ == State::tracking) {
    const bool predicted = predict(result);
    if ((predicted && refine(view, result)) || track_odometry(view, result) || fall_back(view, result)) return true;
    if (predicted) return false;
  }
  {
    const StageTimer timer(result.times, "relocalisation");
    if (!relocaliser_.relocalise(last_keyframe_, reference_keyframe_, view.sensor_frame.colour, view.frame, result))
      return false;
  }
  return refine(view, result);
}

void Tracker::return_from_piece(TrackedView& view, FrameResult& result) {
  // A loop has joined the two, or the camera is back.
  if (map_.piece_of(left_reference_).value_or(piece()) == piece()) {
    left_keyframe_ = left_reference_ = KeyFrameId();
    return;
  }
  constexpr std::uint64_t interval = 3;  // frames; the search takes as long as tracking
  if (result.index % interval != 0) return;
  const Frame in_piece = current_;
  const KeyFrameId reference = reference_keyframe_;
  FrameResult trial = result;
  bool found = false;
  {
    const StageTimer timer(result.times, "relocalisation");
    found = relocaliser_.recover(left_keyframe_, left_reference_, current_, trial);
  }
  if (!found || !track_local_map(view, trial) || trial.inliers < settings_.relocalisation_inliers) {
    current_ = in_piece;
    reference_keyframe_ = reference;
    return;
  }
  trial.times = result.times;
  result = trial;
  history_.interrupt();
  left_keyframe_ = left_reference_ = KeyFrameId();
}

bool Tracker::track_followed(TrackedView& view, FrameResult& result) {
  const double required =
      std::max<double>(settings_.minimum_inliers, settings_.flow_share * static_cast<double>(flow_->size()));
  moving_world_.evaluate(FilterStage::before_matching, view, result.times);
  {
    const StageTimer timer(result.times, "predict");
    const std::vector<MapPointId>& points = flow_->found_points();
    for (std::size_t i = 0; i < points.size(); ++i)
      current_.map_points[i] = map_.find_point(points[i]) == nullptr ? MapPointId() : points[i];
    current_.T_camera_world = predicted_pose();
    if (estimator_.adjust(current_) < required) return false;
    estimator_.drop_outliers(current_);
  }
  place_features(view.sensor_frame, current_.T_camera_world * previous_.T_world_camera(), result.times);
  evaluate_with_pose(view, result);
  moving_world_.evaluate(FilterStage::after_matching, view, result.times);
  const StageTimer timer(result.times, "local map");
  result.inliers = estimator_.adjust(current_);
  count_matches(result);
  estimator_.drop_outliers(current_);
  if (result.inliers < required || is_refuted(result.inliers, false) || (!localises_only_ && needs_keyframe(result)))
    return false;
  result.method = TrackingMethod::flow;
  moving_world_.accumulate(current_);
  return true;
}

bool Tracker::predict(FrameResult& result) {
  const StageTimer timer(result.times, "predict");
  return predict_with_velocity(result) || predict_with_reference(result);
}

bool Tracker::refine(TrackedView& view, FrameResult& result) {
  if (!history_.has_previous()) view.previous = nullptr;  // relocalisation gives the previous frame up
  // The measured motion replaces the predicted one.
  if (history_.has_previous())
    place_features(view.sensor_frame, current_.T_camera_world * previous_.T_world_camera(), result.times);
  evaluate_with_pose(view, result);
  return track_local_map(view, result);
}

bool Tracker::track_odometry(TrackedView& view, FrameResult& result) {
  if (!history_.has_previous() || current_.timestamp > last_feature_time_ + settings_.odometry_time) return false;
  const StageTimer timer(result.times, "odometry");
  const TrackingTrouble trouble = result.trouble;
  const Eigen::Isometry3d predicted = predicted_pose();
  const float window = static_cast<float>(settings_.motion_window);
  const auto match = [&](float radius) {
    current_.T_camera_world = predicted;
    return matcher_.match_previous_features(previous_, radius, current_, odometry_) >= settings_.minimum_matches &&
           estimator_.adjust(current_, odometry_) >= settings_.minimum_matches;
  };
  if (!match(window) && !match(static_cast<float>(settings_.motion_window_retry) * window)) return false;
  moving_world_.evaluate(FilterStage::with_pose, view, result.times);
  estimator_.adjust(current_, odometry_);
  matcher_.match_local_map(static_cast<float>(settings_.local_map_window), current_);
  // Points of one frame are less certain than those of the map: twice as many have to agree.
  const int inliers = estimator_.adjust(current_, odometry_);
  // They may all be on one person, who hides the room: however many they are, no camera jumps.
  constexpr double impossible = 3.0;  // times jump_distance and jump_angle
  if (inliers < 2 * settings_.minimum_inliers || is_refuted(inliers, false) || jumps(impossible) ||
      moving_world_.is_view_filled(current_, reference_keyframe_))
    return false;
  // Where the map ends, the camera would be lost before long; a pose as certain as this begins new map.
  constexpr int certain_inliers = 8;          // times minimum_inliers
  constexpr double certain_deviation = 0.25;  // of maximum_deviation
  odometry_extends_map_ = inliers >= certain_inliers * settings_.minimum_inliers &&
                          estimator_.position_deviation() <= certain_deviation * settings_.maximum_deviation;
  result.method = TrackingMethod::motion_model;
  result.fallback = TrackingFallback::odometry;
  result.matches = estimator_.matches();
  result.inliers = result.static_features = 0;
  for (std::size_t i = 0; i < current_.size(); ++i) {
    if (!is_static(current_, i)) continue;
    ++result.static_features;
    result.inliers += current_.map_points[i].valid() ? 1 : 0;
  }
  result.trouble = trouble;
  moving_world_.accumulate(current_);
  return true;
}

bool Tracker::fall_back(TrackedView& view, FrameResult& result) {
  if (!history_.has_previous()) return false;
  if (moving_world_.discount_priors()) {
    result.fallback = TrackingFallback::masked_features;
    if (predict(result) && refine(view, result)) return true;
  }
  result.fallback = TrackingFallback::dense_depth;
  if (track_dense_depth(view, result)) return true;
  result.fallback = TrackingFallback::none;
  return false;
}

bool Tracker::track_dense_depth(const TrackedView& view, FrameResult& result) {
  const Eigen::Isometry3d predicted = predicted_pose();
  const auto aligned = moving_world_.align_depth(current_, predicted, reference_keyframe_, result.times);
  if (!aligned) return false;
  result.method = TrackingMethod::motion_model;
  const TrackingTrouble trouble = result.trouble;
  // The aligned pose is better than a prediction, but not as good as features: a wide search finds them if there are.
  current_.T_camera_world = *aligned;
  std::fill(current_.map_points.begin(), current_.map_points.end(), MapPointId());
  matcher_.match_local_map(static_cast<float>(settings_.relocalisation_window * settings_.local_map_window), current_);
  estimator_.adjust(current_);
  estimator_.drop_outliers(current_);
  if (track_local_map(view, result)) return true;
  if (current_.timestamp > last_feature_time_ + settings_.depth_only_time) return false;
  current_.T_camera_world = *aligned;
  std::fill(current_.map_points.begin(), current_.map_points.end(), MapPointId());
  result.inliers = result.matches = 0;
  result.trouble = trouble;
  return true;
}

bool Tracker::predict_with_velocity(FrameResult& result) {
  if (!history_.has_previous()) return false;
  const Eigen::Isometry3d predicted = predicted_pose();
  const float window = static_cast<float>(settings_.motion_window);
  for (const float radius : {window, static_cast<float>(settings_.motion_window_retry) * window}) {
    current_.T_camera_world = predicted;
    if (matcher_.match_previous(previous_, radius, current_) < settings_.minimum_matches) continue;
    const int inliers = estimator_.adjust(current_);
    estimator_.drop_outliers(current_);
    if (inliers >= settings_.minimum_matches / 2) {
      result.method = TrackingMethod::motion_model;
      return true;
    }
  }
  result.trouble = TrackingTrouble::few_matches;
  return false;
}

bool Tracker::predict_with_reference(FrameResult& result) {
  const auto start = history_.has_previous() ? std::optional(previous_.T_camera_world) : std::nullopt;
  return relocaliser_.align_with_keyframe(reference_keyframe_, start, current_, result);
}

void Tracker::evaluate_with_pose(const TrackedView& view, FrameResult& result) {
  if (!moving_world_.has(FilterStage::with_pose)) return;
  if (history_.has_velocity()) {
    const PosePrediction prediction{predicted_pose(), previous_.T_world_camera()};
    moving_world_.check_pose(prediction, reference_keyframe_, current_, result.times);
  }
  moving_world_.evaluate(FilterStage::with_pose, view, result.times);
  const Eigen::Isometry3d evaluated_with = current_.T_camera_world;
  if (estimator_.adjust(current_) < settings_.minimum_matches / 2) current_.T_camera_world = evaluated_with;
  estimator_.drop_outliers(current_);
}

bool Tracker::is_sure(int inliers) const { return inliers >= sure_inliers * settings_.minimum_inliers; }

bool Tracker::contradicts_motion(int inliers) const {
  // Two groups of features move rigidly where a person fills much of the view, and the person's may be the larger one.
  // A camera has inertia: from one frame to the next, its velocity changes by little.
  return !is_sure(inliers) && jumps(1.0);
}

bool Tracker::jumps(double factor) const {
  if (!history_.has_previous() || !history_.has_velocity()) return false;
  constexpr double max_interval = 0.2;  // s; later, the prediction says little
  const double interval = current_.timestamp - history_.last_timestamp();
  if (interval > max_interval) return false;
  return contradicts_inertia(current_.T_camera_world * predicted_pose().inverse(), interval, settings_, factor);
}

bool Tracker::lacks_support(int inliers, int static_features) const {
  constexpr double first_age = 0.5;   // s; before, a right map of one camera is small too
  constexpr double min_share = 0.06;  // without people, 0.12 and more; on a person who fills the view, 0.02 to 0.05
  return mono_ && current_.timestamp - map_start_time_ > first_age && inliers < min_share * static_features;
}

bool Tracker::is_refuted(int inliers, bool was_lost) {
  return (!was_lost && contradicts_motion(inliers)) || estimator_.position_deviation() > settings_.maximum_deviation ||
         moving_world_.contradicts_depth(current_, inliers, was_lost, reference_keyframe_);
}

void Tracker::count_matches(FrameResult& result) const {
  result.matches = estimator_.matches();
  result.static_features = static_cast<int>(std::count_if(
      current_.static_probability.begin(), current_.static_probability.end(), [](float p) { return is_static(p); }));
}

bool Tracker::track_local_map(const TrackedView& view, FrameResult& result) {
  {
    const StageTimer timer(result.times, "local map");
    matcher_.match_local_map(static_cast<float>(settings_.local_map_window), current_);
    result.inliers = estimator_.adjust(current_);
  }
  if (result.inliers >= settings_.minimum_inliers &&
      moving_world_.evaluate(FilterStage::after_matching, view, result.times))
    result.inliers = estimator_.adjust(current_);
  const StageTimer timer(result.times, "local map");
  count_matches(result);
  estimator_.drop_outliers(current_);
  matcher_.local_map().count_found(current_);
  const bool was_lost = result.method == TrackingMethod::recovered || result.method == TrackingMethod::relocalised;
  // A wide search finds some agreement anywhere: twice as many have to agree.
  const int required = was_lost ? 2 * settings_.minimum_inliers : settings_.minimum_inliers;
  // Few inliers may lie on a person: they are not taken for a correction of the pose before the loss.
  const bool may_be_anywhere = is_sure(result.inliers) || mono_ || left_reference_.valid();
  if (result.inliers < required || (was_lost && !relocaliser_.is_beyond_chance(result.inliers)) ||
      (was_lost && !may_be_anywhere && !relocaliser_.is_reachable(current_, 0.0)) ||
      lacks_support(result.inliers, result.static_features) || is_refuted(result.inliers, was_lost)) {
    result.trouble = TrackingTrouble::few_inliers;
    return false;
  }
  moving_world_.accumulate(current_);
  reference_keyframe_ = matcher_.local_map().reference_keyframe();
  return true;
}

bool Tracker::needs_keyframe(const FrameResult& result) {
  // Frames that are tracked by the previous one keep their reference, which mapping may have removed since.
  const bool is_kept = map_.find_keyframe(reference_keyframe_) != nullptr;
  const KeyFrameId reference = is_kept ? reference_keyframe_ : matcher_.local_map().reference_keyframe();
  KeyframeSituation situation = keyframe_policy_.measure(current_, result.inliers, reference, map_);
  situation.since_last = current_.timestamp - last_keyframe_time_;
  situation.mask_age = moving_world_.mask_age();
  situation.on_hold = moving_world_.holds_keyframes();
  return keyframe_policy_.decide(situation) != KeyframeReason::none;
}

void Tracker::keyframe_added(KeyFrameId keyframe) {
  const Frame& stored = map_.keyframe(keyframe).frame;
  current_.map_points = stored.map_points;
  current_.T_camera_world = stored.T_camera_world;
  reference_keyframe_ = last_keyframe_ = keyframe;
  last_keyframe_time_ = current_.timestamp;
  backwards_.keyframe_added(keyframe);
  history_.became_keyframe(keyframe, current_.timestamp);
}

bool Tracker::is_of_mono_start(const FrameResult& result) const {
  if (!mono_) return false;
  if (state_ == State::waiting) return result.trouble != TrackingTrouble::no_mask;  // no features are weighted yet
  return state_ == State::tracking && current_.timestamp - map_start_time_ <= settling_time;
}

void Tracker::end_frame(FrameResult& result) {
  pieces_ += begins_piece_ ? 1U : 0U;
  const bool has_pose = result.status == TrackingStatus::initialised || result.status == TrackingStatus::tracked;
  moving_world_.end_frame(current_, has_pose);
  // Until the first mask arrives, the map may have begun on people.
  const bool is_provisional = !start_is_judged_ && moving_world_.expects_masks() && !moving_world_.has_mask();
  constexpr int start_frames = 30;  // as long as a mask may take
  const bool belongs_to_start = is_of_mono_start(result);
  if (is_provisional)
    backwards_.keep(current_, start_frames, result.times);
  else if (belongs_to_start || (!has_pose && !mono_))
    backwards_.keep(current_, settings_.backward_frames, result.times);
  if (!has_pose) {
    history_.interrupt();
    return;
  }
  result.T_world_camera = current_.T_world_camera();
  if (reference_keyframe_.valid()) result.keyframe = reference_keyframe_;
  history_.add(current_, reference_keyframe_, map_);
  if (result.status == TrackingStatus::tracked && !is_provisional && !belongs_to_start && !unconfirmed_)
    backwards_.track(current_, result.times);
}

}  // namespace holdfast
