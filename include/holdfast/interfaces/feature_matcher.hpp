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

/// What the caller of a comparison accepts. A matcher may accept less, or judge by other means.
struct MatchLimits {
  float max_distance = 50.0F;  ///< of the descriptors
  /// Largest quotient of the smallest distance and that of any rival (Lowe 2004, section 7.1). 1 = no such test.
  float ratio = 0.8F;
  /// The query must be the nearest of all queries to its reference, too.
  bool mutual = false;
  /// Whether reference `other` is a rival of the nearest one; empty means all are. A place that was mapped twice is no
  /// reason to refuse a match.
  std::function<bool(std::uint32_t nearest, std::uint32_t other)> is_rival = {};
};

/// Decides which features show the same point. Tracking, local mapping and loop closing call it from several threads at
/// once. The same arguments give the same matches.
///
/// The matching of new points along epipolar lines is not a matcher's: it compares few candidates per feature, and
/// checks the result by triangulation.
class FeatureMatcher : public Module {
 public:
  static constexpr const char* kind = "matcher";

  /// Why this matcher cannot match descriptors of a type, for the message that refuses it before the first frame; ""
  /// when it can.
  virtual std::string trouble_with(const DescriptorType& /*type*/) const { return {}; }
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

/// A NearestMatcher that lives as long as the program, for parts that are given no matcher.
const FeatureMatcher& nearest_matcher();

}  // namespace holdfast
