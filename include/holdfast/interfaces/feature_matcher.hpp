// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/module.hpp"
#include "holdfast/matching/frame_features.hpp"

namespace holdfast {

using matching::FeatureMatch;

/// One side of a comparison: features of an image, or points of a map.
struct MatchSide {
  DescriptorView descriptors;
  std::span<const std::uint32_t> selection = {};  ///< indices of those that take part, ascending

  // Entry i of each belongs to descriptor i. All are empty for points of a map, which no single image shows.
  std::span<const float> x = {}, y = {};      ///< undistorted [px of the full image]
  std::span<const float> angle = {};          ///< orientation [rad]
  std::span<const std::uint8_t> octave = {};  ///< pyramid level
  std::span<const float> response = {};       ///< strength; comparable within one image only
  int width = 0, height = 0;                  ///< of the image [px]
};

/// Features of a frame as one side. The frame and the selection must outlive it.
MatchSide side_of(const Frame& frame, std::span<const std::uint32_t> selection);

/// Acceptance criteria of the caller. A matcher may be stricter or use other criteria.
struct MatchLimits {
  float max_distance = 50.0F;  ///< of the descriptors
  /// Ratio test (Lowe 2004, section 7.1): maximum ratio of the smallest distance to that of any rival. 1 = no test.
  float ratio = 0.8F;
  /// Mutual nearest neighbours: the query must also be the nearest of all queries to its reference.
  bool mutual = false;
  /// Whether reference `other` is a rival of the nearest one in the ratio test, for instance to exclude duplicates of a
  /// place that was mapped twice; empty = all are.
  std::function<bool(std::uint32_t nearest, std::uint32_t other)> is_rival = {};
};

/// Decides which features show the same point. Tracking, local mapping and loop closing call it from several threads at
/// once. The same arguments give the same matches.
///
/// Epipolar matching of new points does not use a matcher: it compares few candidates per feature, and checks the
/// result by triangulation.
class FeatureMatcher : public Module {
 public:
  static constexpr const char* kind = "matcher";

  /// Describes why this matcher cannot match descriptors of a type, for the error before the first frame; "" if it can.
  virtual std::string incompatibility(const DescriptorType& /*type*/) const { return {}; }
  /// Matches queries with references without any prediction: FeatureMatch::source is a query, FeatureMatch::feature a
  /// reference, each of the selections and at most once; ordered by reference. Replaces `matches`. Both sides are of
  /// comparable descriptors.
  virtual void match(const MatchSide& queries, const MatchSide& references, const MatchLimits& limits,
                     std::vector<FeatureMatch>& matches) const = 0;
  /// Matches points that are predicted in a frame with features within their windows; see matching::GuidedSearch, which
  /// this is unless a matcher overrides it. Replaces `matches`.
  virtual void match_guided(const Frame& frame, const FrameSearch::Query& points,
                            const matching::GuidedSearchSettings& settings, std::span<const std::uint8_t> usable,
                            std::vector<FeatureMatch>& matches) const;
};

/// Nearest descriptors within the caller's limits: `matcher: nearest`, the default.
class NearestMatcher : public FeatureMatcher {
 public:
  void match(const MatchSide& queries, const MatchSide& references, const MatchLimits& limits,
             std::vector<FeatureMatch>& matches) const override;
};

/// A NearestMatcher with static lifetime, the default of parts without a configured matcher.
const FeatureMatcher& nearest_matcher();

}  // namespace holdfast
