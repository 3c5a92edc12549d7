// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/interfaces/feature_matcher.hpp"

#include "holdfast/matching/descriptor_matching.hpp"

namespace holdfast {

MatchSide side_of(const Frame& frame, std::span<const std::uint32_t> selection) {
  const Features& features = frame.features;
  return {features.descriptors, selection,       frame.x,           frame.y,
          features.angle,       features.octave, features.response, frame.camera->width,
          frame.camera->height};
}

void FeatureMatcher::match_guided(const Frame& frame, const FrameSearch::Query& points,
                                  const matching::GuidedSearchSettings& settings, std::span<const std::uint8_t> usable,
                                  std::vector<FeatureMatch>& matches) const {
  thread_local FrameSearch search;  // keeps its buffers
  matches = search.match(frame, points, settings, usable);
}

void NearestMatcher::match(const MatchSide& queries, const MatchSide& references, const MatchLimits& limits,
                           std::vector<FeatureMatch>& matches) const {
  thread_local matching::DescriptorMatcher<DescriptorView> matcher;  // keeps its buffers
  const matching::DescriptorMatchingSettings settings{
      .max_distance = limits.max_distance, .ratio = limits.ratio, .mutual = limits.mutual};
  const auto is_rival = [&](std::uint32_t nearest, std::uint32_t other) {
    return !limits.is_rival || limits.is_rival(nearest, other);
  };
  matches = matcher.match({queries.descriptors, queries.selection}, {references.descriptors, references.selection},
                          settings, is_rival);
}

const FeatureMatcher& nearest_matcher() {
  static const NearestMatcher matcher;
  return matcher;
}

}  // namespace holdfast
