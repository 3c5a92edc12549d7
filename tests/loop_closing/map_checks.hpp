// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "holdfast/core/map.hpp"

namespace holdfast::test {

/// What Map promises: a feature names a point exactly when the point lists the observation, edges have two ends, and no
/// id names what is gone.
inline void expect_consistent(const Map& map) {
  std::size_t named = 0, listed = 0;
  map.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    for (std::uint32_t i = 0; i < keyframe.frame.size(); ++i) {
      const MapPointId point = keyframe.frame.map_points[i];
      if (!point.valid()) continue;
      ++named;
      ASSERT_NE(map.find_point(point), nullptr);
      ASSERT_EQ(map.feature_of(point, id), static_cast<int>(i));
    }
    for (const CovisibilityEdge& edge : keyframe.covisible) {
      const KeyFrame* other = map.find_keyframe(edge.keyframe);
      ASSERT_NE(other, nullptr);
      ASSERT_TRUE(std::any_of(other->covisible.begin(), other->covisible.end(),
                              [&](const CovisibilityEdge& e) { return e.keyframe == id && e.weight == edge.weight; }));
    }
    for (const KeyFrameId other : keyframe.loop_edges) ASSERT_NE(map.find_keyframe(other), nullptr);
    const Eigen::Matrix3d rotation = keyframe.frame.T_camera_world.linear();
    ASSERT_LT((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  });
  map.points().for_each([&](MapPointId, const MapPoint& point) {
    listed += point.observations.size();
    ASSERT_FALSE(point.observations.empty());
    ASSERT_NE(map.find_keyframe(point.reference_keyframe), nullptr);
    ASSERT_NEAR(point.viewing_direction.norm(), 1.0, 1e-6);
  });
  ASSERT_EQ(named, listed);
}

}  // namespace holdfast::test
