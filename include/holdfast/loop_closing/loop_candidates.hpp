// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/interfaces/loop_detector.hpp"
#include "holdfast/loop_closing/loop_closing_settings.hpp"

namespace holdfast {

/// Selects loop candidates among the keyframes similar to the current one (Mur-Artal et al. 2015, section VII-A).
///
/// Excluded are keyframes of the neighbourhood (up to two steps in the covisibility graph, because tracking already
/// uses their points), recent keyframes, and keyframes that are less similar to the current one than its least similar
/// neighbour. The others are grouped by covisibility, and a group must be consistent over several consecutive
/// keyframes, which is rare for false matches. Keyframes of another submap are exempt from these conditions, because
/// both submaps may be in view for a moment only; the geometric check decides. Used by one thread.
class LoopCandidates {
 public:
  explicit LoopCandidates(const LoopClosingSettings& settings) : settings_(settings) {}

  /// Number of matches to request from the detector: the configured number plus those that may be excluded as
  /// neighbours or as recent.
  int matches_to_ask_for(const Map& map, KeyFrameId keyframe) const;

  /// The best keyframe of each consistent group, best group first. It must be called for each keyframe in order.
  /// Matches whose keyframe is not in the map are ignored.
  std::vector<KeyFrameId> choose(const Map& map, KeyFrameId keyframe, std::span<const PlaceMatch> matches);

  /// Removes the groups of earlier keyframes; called after a loop closure.
  void clear() { groups_.clear(); }

 private:
  struct Group {
    KeyFrameId best;
    double score = 0.0;                 ///< sum of the scores of its candidates
    std::vector<KeyFrameId> keyframes;  ///< the best and its neighbours, sorted
    int times = 1;                      ///< number of consecutive keyframes
  };
  std::vector<Group> group(const Map& map, std::span<const PlaceMatch> candidates) const;

  LoopClosingSettings settings_;
  std::vector<Group> groups_;  // of the previous keyframe
};

/// Marks the keyframe and all keyframes within two steps in the covisibility graph by 1 at their slots.
std::vector<std::uint8_t> neighbourhood_of(const Map& map, KeyFrameId keyframe);

}  // namespace holdfast
