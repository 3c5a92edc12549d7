// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/view_motion.hpp"

#include "holdfast/geometry/view_rotation.hpp"
#include "holdfast/matching/frame_features.hpp"

namespace holdfast {

std::vector<std::uint32_t> static_features(const Frame& frame) {
  std::vector<std::uint32_t> features;
  for (std::uint32_t i = 0; i < frame.size(); ++i)
    if (is_static(frame, i)) features.push_back(i);
  return features;
}

std::optional<FrameMotion> rotation_since(const Frame& previous, const Frame& frame, const FeatureMatcher& matcher,
                                          float max_distance) {
  const double interval = frame.timestamp - previous.timestamp;
  if (previous.size() == 0 || !(interval > 0.0)) return std::nullopt;
  const std::vector<std::uint32_t> there = static_features(previous), here = static_features(frame);
  std::vector<FeatureMatch> matches;
  matcher.match(side_of(previous, there), side_of(frame, here), {.max_distance = max_distance, .mutual = true},
                matches);
  std::vector<Eigen::Vector3d> a, b;
  for (const FeatureMatch& match : matches) {
    a.push_back(frame.camera->back_project(previous.x[match.source], previous.y[match.source], 1.0).normalized());
    b.push_back(frame.camera->back_project(frame.x[match.feature], frame.y[match.feature], 1.0).normalized());
  }
  const std::optional<Eigen::Vector3d> rotation = geometry::view_rotation(a, b);
  if (!rotation) return std::nullopt;
  FrameMotion motion{geometry::Vector6d::Zero(), interval};
  motion.tangent.tail<3>() = *rotation;
  return motion;
}

}  // namespace holdfast
