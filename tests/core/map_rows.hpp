// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::test {

inline Frame frame_with(std::size_t features, double timestamp, const Eigen::Vector3d& position) {
  static const auto camera = std::make_shared<const Camera>();
  static const auto pyramid = std::make_shared<const ScalePyramid>();
  Frame frame;
  frame.timestamp = timestamp;
  frame.camera = camera;
  frame.pyramid = pyramid;
  frame.features.resize(features);
  frame.x.assign(features, 100.0F);
  frame.y.assign(features, 100.0F);
  frame.depth.assign(features, 1.0F);
  frame.right_x.assign(features, 58.0F);
  frame.map_points.assign(features, MapPointId());
  frame.static_probability.assign(features, 1.0F);
  Random random(static_cast<std::uint64_t>(timestamp * 1000) + 7);
  for (Descriptor256& descriptor : frame.features.descriptors.of_256_bits())
    for (std::uint64_t& word : descriptor.words) word = random.next();
  frame.T_camera_world = Eigen::Isometry3d(Eigen::Translation3d(position)).inverse();
  return frame;
}

/// Both directions of every link agree, edges are symmetric and sorted, and the spanning tree has no cycle.
inline void expect_consistent(const Map& map) {
  map.points().for_each([&](MapPointId id, const MapPoint& point) {
    std::set<KeyFrameId> seen;
    for (const Observation& o : point.observations) {
      ASSERT_NE(map.find_keyframe(o.keyframe), nullptr);
      EXPECT_EQ(map.keyframe(o.keyframe).frame.map_points.at(o.feature), id);
      EXPECT_TRUE(seen.insert(o.keyframe).second) << "a keyframe sees a point twice";
    }
    ASSERT_FALSE(point.observations.empty());
    EXPECT_TRUE(seen.contains(point.reference_keyframe));
  });
  map.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    for (std::uint32_t f = 0; f < keyframe.frame.map_points.size(); ++f) {
      const MapPointId point = keyframe.frame.map_points[f];
      if (point.valid()) {
        ASSERT_NE(map.find_point(point), nullptr);
        EXPECT_EQ(map.feature_of(point, id), static_cast<int>(f));
      }
    }
    int last = 1 << 30;
    for (const CovisibilityEdge& edge : keyframe.covisible) {
      EXPECT_LE(edge.weight, last);
      last = edge.weight;
      const auto& back = map.keyframe(edge.keyframe).covisible;
      EXPECT_EQ(std::count_if(back.begin(), back.end(),
                              [&](const auto& e) { return e.keyframe == id && e.weight == edge.weight; }),
                1);
    }
    if (keyframe.parent.valid()) {
      EXPECT_LT(map.keyframe(keyframe.parent).sequence, keyframe.sequence);
    }
    for (const KeyFrameId child : keyframe.children) EXPECT_EQ(map.keyframe(child).parent, id);
  });
}

/// Keyframes in a row; each shares its points with the two before it.
inline std::vector<KeyFrameId> build_row(Map& map, int keyframes, std::size_t features = 60) {
  std::vector<KeyFrameId> ids;
  std::vector<MapPointId> points;
  for (int k = 0; k < keyframes; ++k) {
    Frame frame = frame_with(features, k + 1.0, {0.1 * k, 0, 0});
    for (std::size_t f = 0; f < features * 2 / 3 && f + features / 3 < points.size(); ++f)
      frame.map_points[f] =
          points[points.size() - features * 2 / 3 + f < points.size() ? points.size() - features * 2 / 3 + f : 0];
    const KeyFrameId id = map.add_keyframe(frame);
    for (std::uint32_t f = 0; f < features; ++f) {
      if (map.keyframe(id).frame.map_points[f].valid()) continue;
      const MapPointId point = map.add_point({0.1 * k + 0.01 * f, 0.02 * f, 2.0}, map.keyframe(id).sequence);
      map.add_observation(point, id, f);
      points.push_back(point);
    }
    for (const MapPointId point : map.keyframe(id).frame.map_points) map.update_point(point);
    map.set_covisibility_minimum(5);
    map.update_covisibility(id);
    ids.push_back(id);
  }
  return ids;
}

}  // namespace holdfast::test
