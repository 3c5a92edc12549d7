// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/interfaces/loop_detector.hpp"
#include "holdfast/loop_closing/loop_closing_settings.hpp"

namespace holdfast {

/// Which of the keyframes that look like the current one may be the same place (Mur-Artal et al. 2015, section VII-A).
///
/// Left out: keyframes of the neighbourhood (up to two steps in the covisibility graph: tracking already uses their
/// points), keyframes that are too young, and keyframes that look less like the current one than its least alike
/// neighbour does. The rest is grouped by covisibility, and a group must turn up for several keyframes in a row: the
/// same wrong place seldom does. Looks at the map; the caller holds its lock. One thread.
class LoopCandidates {
 public:
  explicit LoopCandidates(const LoopClosingSettings& settings) : settings_(settings) {}

  /// How many matches to ask the detector for, so that the neighbours do not use up the answer.
  int matches_to_ask_for(const Map& map, KeyFrameId keyframe) const;

  /// The best keyframe of each consistent group, best group first. To be called for each keyframe in turn; matches that
  /// name no keyframe of the map (any more) are passed over.
  std::vector<KeyFrameId> choose(const Map& map, KeyFrameId keyframe, std::span<const PlaceMatch> matches);

  /// Forgets the groups of earlier keyframes: after a loop.
  void clear() { groups_.clear(); }

 private:
  struct Group {
    KeyFrameId best;
    double score = 0.0;                 ///< sum of the candidates in it
    std::vector<KeyFrameId> keyframes;  ///< the best and its neighbours, sorted
    int times = 1;                      ///< keyframes in a row
  };
  std::vector<Group> group(const Map& map, std::span<const PlaceMatch> candidates) const;

  LoopClosingSettings settings_;
  std::vector<Group> groups_;  // of the keyframe before
};

/// The keyframe and all within two steps in the covisibility graph: 1 at their slots.
std::vector<std::uint8_t> neighbourhood_of(const Map& map, KeyFrameId keyframe);

}  // namespace holdfast
