// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/loop_closing/loop_closer.hpp"

#include "holdfast/core/random.hpp"
#include "loop_correction.hpp"
#include "place_check.hpp"
#include "plausibility.hpp"

namespace holdfast {

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
    case LoopVerdict::one_corner:
      return "one corner";
    case LoopVerdict::implausible_correction:
      return "implausible correction";
    case LoopVerdict::pose_confirmed:
      return "pose confirmed";
    case LoopVerdict::not_solved:
      return "not solved";
  }
  return "";
}

LoopCloser::LoopCloser(const LoopClosingSettings& settings, Map& map, MapMutex& map_mutex, std::mutex& work,
                       LoopDetector& detector, Optimizer& optimizer, std::uint64_t seed)
    : settings_(settings),
      map_(map),
      map_mutex_(map_mutex),
      work_(work),
      detector_(detector),
      optimizer_(optimizer),
      seed_(seed),
      candidates_(settings) {}

std::optional<ClosedLoop> LoopCloser::process(KeyFrameId keyframe, StageTimes& times) {
  std::vector<KeyFrameId> chosen;
  {
    const StageTimer timer(times, "loops: candidates");
    chosen = find_candidates(keyframe);
  }
  if (chosen.empty()) return std::nullopt;
  const std::lock_guard surgery(work_);
  std::optional<ClosedLoop> closed;
  for (const KeyFrameId candidate : chosen) {
    closed = close(keyframe, candidate, times);
    if (closed) break;
  }
  return closed;
}

std::vector<KeyFrameId> LoopCloser::find_candidates(KeyFrameId id) {
  std::vector<Descriptor> descriptors;
  int ask_for = 0;
  std::uint64_t sequence = 0;
  {
    const std::lock_guard lock(map_mutex_);
    const KeyFrame* keyframe = map_.find_keyframe(id);
    if (keyframe == nullptr) {
      ++counts_.removed;
      return {};
    }
    descriptors = keyframe->frame.features.descriptors;
    sequence = keyframe->sequence;
    ask_for = candidates_.matches_to_ask_for(map_, id);
  }
  ++counts_.keyframes;
  const std::vector<PlaceMatch> matches = detector_.query(descriptors, ask_for);
  detector_.add(id, descriptors);
  if (last_loop_ && sequence < *last_loop_ + static_cast<std::uint64_t>(settings_.pause)) return {};

  const std::lock_guard lock(map_mutex_);
  if (map_.find_keyframe(id) == nullptr) return {};
  return candidates_.choose(map_, id, matches);
}

std::optional<ClosedLoop> LoopCloser::close(KeyFrameId keyframe_id, KeyFrameId candidate, StageTimes& times) {
  // `work` is held: keyframes stay, and so do the poses and features that are read without the map's lock.
  const auto verdict = [this](LoopVerdict value) {
    ++counts_.verdicts[static_cast<std::size_t>(value)];
    return value;
  };
  LoopMeasurement measurement{keyframe_id, candidate, Eigen::Isometry3d::Identity(), {}};
  ClosedLoop loop;
  {
    const StageTimer timer(times, "loops: check");
    const Frame* frame = nullptr;
    PlacePoints place;
    std::uint64_t sequence = 0;
    {
      const std::lock_guard lock(map_mutex_);
      const KeyFrame* keyframe = map_.find_keyframe(keyframe_id);
      if (keyframe == nullptr || map_.find_keyframe(candidate) == nullptr) return std::nullopt;
      frame = &keyframe->frame;
      sequence = keyframe->sequence;
      std::vector<KeyFrameId> side = {candidate};
      for (const KeyFrameId neighbour : map_.best_covisible(candidate, settings_.neighbours)) side.push_back(neighbour);
      place = points_seen_by(map_, side);
    }
    const CheckedPlace checked = check_place(settings_, optimizer_, *frame, place, Random(seed_).fork(sequence).next());
    if (checked.verdict != LoopVerdict::closed) {
      verdict(checked.verdict);
      return std::nullopt;
    }
    measurement.T_camera_world = checked.T_camera_world;
    for (const PointMatch& match : checked.inliers)
      measurement.points.emplace_back(place.ids[match.point], match.feature);

    const PoseChange change = pose_change(frame->T_camera_world, checked.T_camera_world);
    PlacePoints old_points;
    {
      const std::lock_guard lock(map_mutex_);
      loop.way = way_between(map_, keyframe_id, candidate);
      loop.T_keyframe_candidate = checked.T_camera_world * map_.keyframe(candidate).frame.T_camera_world.inverse();
      old_points = old_points_in_view(settings_, map_, keyframe_id);
    }
    const PoseChange believed = believed_drift(settings_, loop.way);
    if (change.metres > believed.metres || change.degrees > believed.degrees) {
      verdict(LoopVerdict::implausible_correction);
      return std::nullopt;
    }
    if (present_pose_is_confirmed(settings_, optimizer_, *frame, old_points, checked.T_camera_world)) {
      verdict(LoopVerdict::pose_confirmed);
      return std::nullopt;
    }
    loop.keyframe = keyframe_id;
    loop.candidate = candidate;
    loop.inliers = static_cast<int>(checked.inliers.size());
    loop.correction_metres = change.metres;
    loop.correction_degrees = change.degrees;
    last_loop_ = sequence;
  }

  const StageTimer timer(times, "loops: correction");
  const Stopwatch watch;
  if (adjustment_ != nullptr) adjustment_->request_stop();
  LoopCorrection correction(settings_, map_, map_mutex_, optimizer_, measurement);
  if (!correction.run()) {
    verdict(LoopVerdict::not_solved);
    return std::nullopt;
  }
  verdict(LoopVerdict::closed);
  candidates_.clear();
  loop.points_fused = correction.points_fused();
  counts_.points_fused += static_cast<std::uint64_t>(loop.points_fused);
  loop.seconds = watch.seconds();
  return loop;
}

}  // namespace holdfast
