// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "holdfast/geometry/view_rotation.hpp"
#include "holdfast/interfaces/feature_matcher.hpp"
#include "holdfast/matching/frame_features.hpp"
#include "holdfast/tracking/rolling_shutter.hpp"

namespace holdfast {

/// The motion of one camera since the previous frame while there is no map: the rotation between the static features of
/// both frames that match (geometry::view_rotation), without a translation, since the parallax of one frame interval is
/// small. Empty if too few features match, or without a previous frame.
inline std::optional<FrameMotion> rotation_since(const Frame& previous, const Frame& frame) {
  const double interval = frame.timestamp - previous.timestamp;
  if (previous.size() == 0 || !(interval > 0.0)) return std::nullopt;
  const auto static_features = [](const Frame& each) {
    std::vector<std::uint32_t> features;
    for (std::uint32_t i = 0; i < each.size(); ++i)
      if (is_static(each, i)) features.push_back(i);
    return features;
  };
  const std::vector<std::uint32_t> there = static_features(previous), here = static_features(frame);
  std::vector<FeatureMatch> matches;
  nearest_matcher().match(side_of(previous, there), side_of(frame, here),
                          {.max_distance = frame.features.descriptors.type().strict_distance, .mutual = true}, matches);
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
