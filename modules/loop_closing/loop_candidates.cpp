// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/loop_closing/loop_candidates.hpp"

#include <algorithm>

namespace holdfast {

std::vector<std::uint8_t> neighbourhood_of(const Map& map, KeyFrameId keyframe) {
  std::vector<std::uint8_t> near(map.keyframes().slot_count(), 0);
  near[keyframe.slot] = 1;
  for (const CovisibilityEdge& edge : map.keyframe(keyframe).covisible) {
    near[edge.keyframe.slot] = 1;
    for (const CovisibilityEdge& second : map.keyframe(edge.keyframe).covisible) near[second.keyframe.slot] = 1;
  }
  return near;
}

int LoopCandidates::matches_to_ask_for(const Map& map, KeyFrameId keyframe) const {
  const std::vector<std::uint8_t> near = neighbourhood_of(map, keyframe);
  return settings_.candidates + settings_.minimum_gap + static_cast<int>(std::count(near.begin(), near.end(), 1));
}

std::vector<KeyFrameId> LoopCandidates::choose(const Map& map, KeyFrameId keyframe_id,
                                               std::span<const PlaceMatch> matches) {
  const KeyFrame& keyframe = map.keyframe(keyframe_id);
  const std::vector<std::uint8_t> near = neighbourhood_of(map, keyframe_id);
  double least_neighbour = 0.0;  // matches are sorted by decreasing score: the last neighbour has the lowest one
  for (const PlaceMatch& match : matches)
    for (const CovisibilityEdge& edge : keyframe.covisible)
      if (edge.keyframe == match.keyframe) least_neighbour = match.score;

  std::vector<PlaceMatch> candidates;
  for (const PlaceMatch& match : matches) {
    const KeyFrame* other = map.find_keyframe(match.keyframe);
    if (other == nullptr || near[match.keyframe.slot] != 0) continue;
    if (other->submap == keyframe.submap) {
      if (other->sequence + static_cast<std::uint64_t>(settings_.minimum_gap) > keyframe.sequence) continue;
      if (match.score < settings_.score_share * least_neighbour) continue;
    }
    candidates.push_back(match);
    if (static_cast<int>(candidates.size()) == settings_.candidates) break;
  }

  std::vector<Group> groups = group(map, candidates);
  std::vector<KeyFrameId> chosen;
  for (Group& now : groups) {
    for (const Group& before : groups_) {
      const bool shared = std::any_of(now.keyframes.begin(), now.keyframes.end(), [&](KeyFrameId id) {
        return std::binary_search(before.keyframes.begin(), before.keyframes.end(), id);
      });
      if (shared) now.times = std::max(now.times, before.times + 1);
    }
    const bool may_join_submaps = map.keyframe(now.best).submap != keyframe.submap;
    if (may_join_submaps || now.times >= settings_.consistent_keyframes) chosen.push_back(now.best);
  }
  groups_ = std::move(groups);
  return chosen;
}

std::vector<LoopCandidates::Group> LoopCandidates::group(const Map& map, std::span<const PlaceMatch> candidates) const {
  std::vector<Group> groups;
  for (const PlaceMatch& match : candidates) {
    // Candidates are sorted by decreasing score, so a neighbour of a better candidate belongs to its group.
    const auto home = std::find_if(groups.begin(), groups.end(), [&](const Group& g) {
      return std::binary_search(g.keyframes.begin(), g.keyframes.end(), match.keyframe);
    });
    if (home != groups.end()) {
      home->score += match.score;
      continue;
    }
    Group made{match.keyframe, match.score, {match.keyframe}, 1};
    for (const CovisibilityEdge& edge : map.keyframe(match.keyframe).covisible) made.keyframes.push_back(edge.keyframe);
    std::sort(made.keyframes.begin(), made.keyframes.end());
    groups.push_back(std::move(made));
  }
  std::stable_sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) { return a.score > b.score; });
  const double least = groups.empty() ? 0.0 : settings_.group_share * groups.front().score;
  std::erase_if(groups, [&](const Group& g) { return g.score < least; });
  return groups;
}

}  // namespace holdfast
