// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/loop_closing/loop_closer.hpp"

#include <cmath>

#include "holdfast/core/random.hpp"
#include "holdfast/matching/frame_features.hpp"
#include "loop_correction.hpp"
#include "place_check.hpp"
#include "plausibility.hpp"

namespace holdfast {

namespace {
/// Path for each second of a bridge [m/s]; drift_per_metre of it are 0.5 m: the odometry may follow a person.
constexpr double unseen_speed = 25.0;
constexpr double longest_unseen = 5.0 * unseen_speed;  // [m], of the whole path

/// Length that a path may be given for views that hardly hold the camera [m].
double unseen_length(const Map& map, KeyFrameId from, KeyFrameId to, double length) {
  return std::min(longest_unseen, path_length(map, from, to, unseen_speed) - length);
}
}  // namespace

const char* loop_verdict_name(LoopVerdict verdict) {
  switch (verdict) {
    case LoopVerdict::closed:
      return "closed";
    case LoopVerdict::few_matches:
      return "few matches";
    case LoopVerdict::no_alignment:
      return "no alignment";
    case LoopVerdict::few_inliers:
      return "few inliers";
    case LoopVerdict::small_share:
      return "small share";
    case LoopVerdict::poor_coverage:
      return "one corner";
    case LoopVerdict::implausible_correction:
      return "implausible correction";
    case LoopVerdict::pose_confirmed:
      return "pose confirmed";
    case LoopVerdict::other_classes:
      return "other classes";
    case LoopVerdict::not_solved:
      return "not solved";
  }
  return "";
}

LoopCloser::LoopCloser(const LoopClosingSettings& settings, const SharedMap& shared, LoopDetector& detector,
                       Optimizer& optimizer, std::uint64_t seed, const FeatureMatcher& matcher)
    : settings_(settings),
      map_(shared.map),
      map_mutex_(shared.mutex),
      structure_mutex_(shared.structure_mutex),
      detector_(detector),
      optimizer_(optimizer),
      matcher_(matcher),
      seed_(seed),
      candidates_(settings) {}

std::optional<ClosedLoop> LoopCloser::process(KeyFrameId keyframe, StageTimes& times) {
  std::vector<KeyFrameId> chosen;
  {
    const StageTimer timer(times, "loops: candidates");
    chosen = find_candidates(keyframe);
  }
  if (chosen.empty()) return std::nullopt;

  const std::lock_guard structure(structure_mutex_);
  std::optional<ClosedLoop> closed;
  for (const KeyFrameId candidate : chosen) {
    CandidateReport trial;
    trial.keyframe = keyframe;
    trial.candidate = candidate;
    std::optional<LoopMeasurement> measurement;
    {
      const StageTimer timer(times, "loops: check");
      measurement = check(trial);
    }
    if (measurement) {
      const StageTimer timer(times, "loops: correction");
      closed = correct(structure, trial, *measurement);
    }
    ++counts_.verdicts[static_cast<std::size_t>(trial.verdict)];
    if (closed) break;
  }
  return closed;
}

std::vector<KeyFrameId> LoopCloser::find_candidates(KeyFrameId id) {
  DescriptorBlock descriptors;
  std::vector<float> weights;
  int ask_for = 0;
  std::uint64_t sequence = 0;
  {
    const std::lock_guard lock(map_mutex_);
    const KeyFrame* keyframe = map_.find_keyframe(id);
    if (keyframe == nullptr) {
      ++counts_.removed;
      return {};
    }
    if (!weights_) weights_.emplace(detector_, map_.classes());
    const bool of_image = detector_.image_descriptor().has_value();
    descriptors = place_descriptors(keyframe->frame, of_image);
    if (!of_image) weights = weights_->of_static_features(keyframe->frame);
    sequence = keyframe->sequence;
    ask_for = candidates_.matches_to_ask_for(map_, id);
  }
  ++counts_.keyframes;
  const std::vector<PlaceMatch> matches =
      weights.empty() ? detector_.query(descriptors, ask_for) : detector_.query_weighted(descriptors, weights, ask_for);
  detector_.add(id, descriptors);
  if (last_loop_ && sequence < *last_loop_ + static_cast<std::uint64_t>(settings_.pause)) return {};

  const std::lock_guard lock(map_mutex_);
  if (map_.find_keyframe(id) == nullptr) return {};
  return candidates_.choose(map_, id, matches);
}

std::optional<LoopMeasurement> LoopCloser::check(CandidateReport& trial) {
  // The structure mutex is held: keyframes, poses and features may be read without the map's lock.
  const Frame* frame = nullptr;
  PlacePoints place;
  LocatedFeatures located;
  std::uint64_t sequence = 0;
  {
    const std::lock_guard lock(map_mutex_);
    const KeyFrame* keyframe = map_.find_keyframe(trial.keyframe);
    if (keyframe == nullptr || map_.find_keyframe(trial.candidate) == nullptr) return std::nullopt;
    frame = &keyframe->frame;
    sequence = keyframe->sequence;
    located = located_features(*frame, map_);
    std::vector<KeyFrameId> side = {trial.candidate};
    for (const KeyFrameId neighbour : map_.best_covisible(trial.candidate, settings_.neighbours))
      side.push_back(neighbour);
    place = copy_points_seen_by(map_, side);
    if (!weights_->are_uniform()) copy_votes(map_, place);
  }
  const CheckedPlace checked = check_place(settings_, matcher_, optimizer_, *frame, located, place,
                                           Random(seed_).fork(sequence).next(), *weights_);
  trial.verdict = checked.verdict;
  trial.matches = checked.matches;
  trial.aligned = checked.aligned;
  trial.inliers = static_cast<int>(checked.inliers.size());
  trial.expected = checked.expected;
  trial.cells = checked.cells;
  trial.class_agreement = checked.class_agreement;
  if (checked.verdict != LoopVerdict::closed) return std::nullopt;

  PlacePoints old_points;
  double unseen = 0.0;
  {
    const std::lock_guard lock(map_mutex_);
    trial.joins_submaps = map_.keyframe(trial.keyframe).submap != map_.keyframe(trial.candidate).submap;
    if (!trial.joins_submaps) {
      trial.path_length = path_length(map_, trial.keyframe, trial.candidate);
      // The unit of one camera's map is not the metre.
      if (is_inertial_ && features_have_depth(map_.sensor()))
        unseen = unseen_length(map_, trial.keyframe, trial.candidate, trial.path_length);
      old_points = old_points_in_view(settings_, map_, trial.keyframe);
    }
  }
  trial.correction = pose_change(frame->T_camera_world, checked.T_camera_world);
  trial.scale = checked.scale;
  const PoseChange bound = drift_bound(settings_, trial.path_length + unseen, located.scale_is_free);
  const bool scale_is_plausible = std::abs(std::log(checked.scale)) <= std::log(settings_.largest_scale_drift);
  if (trial.joins_submaps)
    trial.verdict = LoopVerdict::closed;  // the pose of one submap relative to the other was a guess
  else if (trial.correction.metres > bound.metres || trial.correction.degrees > bound.degrees || !scale_is_plausible)
    trial.verdict = LoopVerdict::implausible_correction;
  else if (present_pose_is_confirmed(settings_, matcher_, optimizer_, *frame, old_points, checked.T_camera_world))
    trial.verdict = LoopVerdict::pose_confirmed;
  if (trial.verdict != LoopVerdict::closed) return std::nullopt;

  LoopMeasurement measurement{trial.keyframe,        trial.candidate, checked.T_camera_world, {},
                              located.scale_is_free, checked.scale};
  for (const matching::FeatureMatch& match : checked.inliers)
    measurement.points.emplace_back(place.block.ids[match.source], match.feature);
  return measurement;
}

std::optional<ClosedLoop> LoopCloser::correct(const std::lock_guard<std::mutex>& structure, CandidateReport& trial,
                                              const LoopMeasurement& measurement) {
  const Stopwatch watch;
  if (adjustment_ != nullptr) adjustment_->request_stop();
  ClosedLoop loop{.keyframe = trial.keyframe,
                  .candidate = trial.candidate,
                  .inliers = trial.inliers,
                  .joins_submaps = trial.joins_submaps,
                  .path_length = trial.path_length,
                  .correction = trial.correction,
                  .scale = trial.scale};
  {
    const std::lock_guard lock(map_mutex_);
    const Eigen::Isometry3d T_world_candidate = map_.keyframe(trial.candidate).frame.T_world_camera();
    loop.T_keyframe_candidate = measurement.T_camera_world * T_world_candidate;
    last_loop_ = map_.keyframe(trial.keyframe).sequence;
  }
  LoopCorrection correction(settings_, map_, map_mutex_, optimizer_, matcher_, measurement);
  if (!correction.run(structure)) {
    trial.verdict = LoopVerdict::not_solved;
    return std::nullopt;
  }
  candidates_.clear();
  loop.points_fused = correction.points_fused();
  counts_.points_fused += static_cast<std::uint64_t>(loop.points_fused);
  loop.seconds = watch.seconds();
  return loop;
}

}  // namespace holdfast
