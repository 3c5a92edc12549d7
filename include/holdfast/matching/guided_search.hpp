// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "holdfast/matching/nearest.hpp"
#include "holdfast/matching/reprojection.hpp"
#include "holdfast/matching/rotation_consistency.hpp"
#include "holdfast/matching/search_windows.hpp"
#include "holdfast/matching/traits.hpp"

namespace holdfast::matching {

/// Test of the distance between a feature and its predicted position.
enum class PositionGate {
  window,     ///< within the window in the image and, if both right columns are known, in the right image
  chi_square  ///< within the window, and within the 95 % ellipse of the feature's noise; for accurate poses
};

/// Selects which of several points that match one feature are returned.
enum class FeatureAssignment {
  nearest_point,  ///< a feature is matched with the point of the smallest distance only, the first of equal ones
  every_point     ///< each point keeps its feature, so that duplicates of a point are found
};

/// Settings of a guided search.
struct GuidedSearchSettings {
  float max_distance = 100.0F;  ///< of the descriptors, in their unit (bits for binary ones)
  /// Ratio test: maximum ratio of the smallest to the second smallest distance, if both features lie on the same
  /// octave, because repeated texture is ambiguous. 1 = no test.
  float ratio = 1.0F;
  PositionGate position = PositionGate::window;
  FeatureAssignment assignment = FeatureAssignment::nearest_point;
};

/// Matches points, predicted in a view, with the features of the view: the nearest descriptor within the window and the
/// octaves of each point. An object keeps its buffers between calls and serves one thread.
template <FeatureView View>
class GuidedSearch {
 public:
  using Traits = ViewTraits<View>;
  using Descriptors = typename Traits::Descriptors;
  using Distance = DistanceOf<Descriptors>;
  using FoundMatch = Match<Distance>;

  /// The points to search for. Descriptors and angles are indexed by SearchWindows::source.
  struct Query {
    const SearchWindows& windows;
    Descriptors descriptors;
    /// Orientations at which the points were last seen [rad]. If not empty, matches whose rotation is not among the
    /// most frequent ones are dropped; see keep_consistent_rotations().
    std::span<const float> angles = {};
  };

  /// Searches the features of a view. `usable` has one entry for each feature, 0 = excluded; empty = all are used. The
  /// matches are ordered by feature, or by window with FeatureAssignment::every_point, and valid until the next call.
  const std::vector<FoundMatch>& match(const View& view, const Query& query, const GuidedSearchSettings& settings,
                                       std::span<const std::uint8_t> usable = {}) {
    matches_.clear();
    const bool shares_features = settings.assignment == FeatureAssignment::every_point;
    if (!shares_features) best_of_feature_.assign(Traits::size(view), FoundMatch{0, 0, unmatched});
    const Descriptors features = Traits::descriptors(view);
    for (std::size_t window = 0; window < query.windows.size(); ++window) {
      collect_candidates(view, query.windows, window, settings.position, usable);
      if (candidates_.empty()) continue;
      const std::uint32_t source = query.windows.source[window];
      const NearestTwo<Distance> nearest =
          nearest_two(query.descriptors, source, features, std::span<const std::uint32_t>(candidates_), distances_);
      if (static_cast<float>(nearest.best_distance) > settings.max_distance) continue;
      if (is_ambiguous(view, nearest, settings.ratio)) continue;
      const FoundMatch found{source, nearest.best, nearest.best_distance};
      if (shares_features)
        matches_.push_back(found);
      else if (found.distance < best_of_feature_[found.feature].distance)
        best_of_feature_[found.feature] = found;
    }
    if (!shares_features)
      for (const FoundMatch& match : best_of_feature_)
        if (match.distance != unmatched) matches_.push_back(match);
    if (!query.angles.empty())
      keep_consistent_rotations(matches_, [&](const FoundMatch& match) {
        return Traits::angle(view, match.feature) - query.angles[match.source];
      });
    return matches_;
  }

 private:
  static constexpr Distance unmatched = std::numeric_limits<Distance>::max();

  void collect_candidates(const View& view, const SearchWindows& windows, std::size_t window, PositionGate gate,
                          std::span<const std::uint8_t> usable) {
    const float x = windows.x[window], y = windows.y[window], right_x = windows.right_x[window];
    const float radius = windows.radius[window];
    const int min_octave = windows.min_octave[window], max_octave = windows.max_octave[window];
    candidates_.clear();
    Traits::near(view, x, y, radius, candidates_);
    // Branch-free, because the outcome for a feature is unpredictable.
    const bool all_usable = usable.empty();
    std::size_t count = 0;
    for (const std::uint32_t feature : candidates_) {
      const int octave = Traits::octave(view, feature);
      const bool is_expected = (octave >= min_octave) & (octave <= max_octave);
      const bool is_usable = all_usable || usable[feature] != 0;
      const bool is_here = gate == PositionGate::chi_square
                               ? agrees_with_prediction(view, feature, x, y, right_x)
                               : !(std::abs(Traits::right_x(view, feature) - right_x) > radius);  // NaN: unknown
      candidates_[count] = feature;
      count += static_cast<std::size_t>(is_expected & is_usable & is_here);
    }
    candidates_.resize(count);
  }

  static bool is_ambiguous(const View& view, const NearestTwo<Distance>& nearest, float ratio) {
    return nearest.has_second() && Traits::octave(view, nearest.best) == Traits::octave(view, nearest.second) &&
           static_cast<float>(nearest.best_distance) > ratio * static_cast<float>(nearest.second_distance);
  }

  std::vector<std::uint32_t> candidates_;
  std::vector<Distance> distances_;
  std::vector<FoundMatch> best_of_feature_;
  std::vector<FoundMatch> matches_;
};

}  // namespace holdfast::matching
