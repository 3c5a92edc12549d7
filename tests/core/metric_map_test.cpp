// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/metric_map.hpp"

#include <gtest/gtest.h>

#include "core/map_rows.hpp"

namespace holdfast {
namespace {

class MetricMapTest : public testing::Test {
 protected:
  void know_scale(double scale) {
    MapInertia inertia;
    inertia.scale = scale;
    map.set_inertia(inertia);
  }
  Map map;
  std::vector<KeyFrameId> keyframes = test::build_row(map, 6);
};

TEST_F(MetricMapTest, OneCameraMeasuresNoMetresAlone) {
  EXPECT_TRUE(is_metric(map)) << "depth does";
  map.set_sensor(Sensor::mono);
  EXPECT_FALSE(is_metric(map));
  know_scale(2.5);
  EXPECT_FALSE(is_metric(map)) << "its scale is known, and it has its own unit";
  make_metric(map);
  EXPECT_TRUE(is_metric(map));
}

/// What a keyframe sees, where, and from how far, is as before in the new unit.
TEST_F(MetricMapTest, AllLengthsAreScaledTogether) {
  constexpr double scale = 2.5;
  map.set_sensor(Sensor::mono);
  map.remove_keyframe(keyframes[3]);
  know_scale(scale);
  const MapPointId id = map.points().ids().front();
  const MapPoint point = map.point(id);
  const KeyFrameId viewer = point.reference_keyframe;
  map.keyframe(viewer).motion = KeyFrameMotion{{1.0, 2.0, 3.0}, {}};
  const Eigen::Vector3d in_camera = map.pose_of(viewer) * point.position;
  const Eigen::Isometry3d removed = map.pose_of(keyframes[3]);
  const std::uint64_t version = map.version();
  make_metric(map);
  EXPECT_GT(map.version(), version);
  EXPECT_LT((map.pose_of(viewer) * map.point(id).position - scale * in_camera).norm(), 1e-9);
  EXPECT_FLOAT_EQ(map.point(id).minimum_distance, static_cast<float>(scale) * point.minimum_distance);
  EXPECT_FLOAT_EQ(map.point(id).maximum_distance, static_cast<float>(scale) * point.maximum_distance);
  for (const KeyFrameId keyframe : keyframes) EXPECT_DOUBLE_EQ(map.scale_of(keyframe), scale);
  EXPECT_LT((map.pose_of(keyframes[3]).translation() - scale * removed.translation()).norm(), 1e-9);
  EXPECT_DOUBLE_EQ(map.inertia()->scale, 1.0);
  EXPECT_DOUBLE_EQ(map.keyframe(viewer).motion->velocity.y(), 2.0 * scale);
  test::expect_consistent(map);
}

TEST_F(MetricMapTest, MapsInMetresAndThoseWithoutAScaleStay) {
  const Eigen::Vector3d position = map.point(map.points().ids().front()).position;
  const auto is_same = [&] { return map.point(map.points().ids().front()).position == position; };
  know_scale(2.5);
  make_metric(map);
  EXPECT_TRUE(is_same()) << "its depth is in metres";
  map.set_sensor(Sensor::mono);
  map.set_inertia(std::nullopt);
  make_metric(map);
  EXPECT_TRUE(is_same());
}

}  // namespace
}  // namespace holdfast
