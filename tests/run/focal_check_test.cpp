// SPDX-License-Identifier: BSD-3-Clause
#include "focal_check.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <map>

#include "support/point_world.hpp"

namespace holdfast {
namespace {

using testing::HasSubstr;

Camera without_distortion() {
  Camera camera;
  camera.width = 640, camera.height = 480;
  camera.fx = camera.fy = 525.0;
  camera.cx = 319.5, camera.cy = 239.5;
  return camera;
}

/// What a camera saw of the world, as the features of a camera with `given` numbers.
Frame frame_of(test::PointWorld& world, const std::shared_ptr<const Camera>& given,
               const Eigen::Isometry3d& T_world_camera) {
  const SensorFrame images = world.frame(0, 0.0, T_world_camera);
  Frame frame;
  frame.camera = given;
  frame.pyramid = std::make_shared<ScalePyramid>();
  frame.T_camera_world = T_world_camera.inverse();
  frame.features.resize(world.seen().size());
  for (const test::PointWorld::Seen& seen : world.seen()) {
    Random& random = world.random();
    const float depth =
        images.depth.at<float>(static_cast<int>(std::lround(seen.y)), static_cast<int>(std::lround(seen.x)));
    frame.x.push_back(static_cast<float>(seen.x + 0.3 * random.normal()));
    frame.y.push_back(static_cast<float>(seen.y + 0.3 * random.normal()));
    frame.depth.push_back(depth * static_cast<float>(1.0 + 0.003 * random.normal()));
  }
  frame.right_x.assign(frame.features.size(), std::numeric_limits<float>::quiet_NaN());
  frame.static_probability.assign(frame.features.size(), 1.0F);
  frame.map_points.resize(frame.features.size());
  return frame;
}

/// A map of a path that turns by up to `turn` rad, whose camera's focal length is `given_ratio` times the true one.
Map map_of(double given_ratio, double turn) {
  test::PointWorld world(without_distortion());
  auto given = std::make_shared<Camera>(without_distortion());
  given->fx *= given_ratio, given->fy *= given_ratio;
  Map map;
  std::map<std::size_t, MapPointId> ids;
  constexpr int keyframes = 24;
  for (int k = 0; k < keyframes; ++k) {
    Eigen::Isometry3d pose = test::path_pose(0.3 * k);
    pose.linear() = Eigen::AngleAxisd(turn * std::sin(0.4 * k), Eigen::Vector3d::UnitY()).toRotationMatrix();
    const KeyFrameId keyframe = map.add_keyframe(frame_of(world, given, pose));
    for (std::uint32_t i = 0; i < world.seen().size(); ++i) {
      auto [entry, is_new] = ids.try_emplace(world.seen()[i].point);
      if (is_new) entry->second = map.add_point({0, 0, 2}, static_cast<std::uint64_t>(k));
      map.add_observation(entry->second, keyframe, i);
    }
    map.update_covisibility(keyframe);
  }
  return map;
}

TEST(FocalCheck, ATurnTellsTheFocalLength) {
  for (const double given : {0.8, 1.0, 1.25}) {
    const std::optional<FocalRatio> found = estimate_focal_ratio(map_of(given, 0.2));
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->ratio, 1.0 / given, 0.02);
    EXPECT_LT(found->deviation, 0.01);
  }
}

TEST(FocalCheck, WithoutATurnNothingIsSuspected) {
  const std::optional<FocalRatio> found = estimate_focal_ratio(map_of(1.25, 0.0));
  if (found) {
    EXPECT_EQ(focal_warning(*found, without_distortion()), "") << found->ratio << " " << found->deviation;
  }
  EXPECT_FALSE(estimate_focal_ratio(Map()));
}

TEST(FocalCheck, TheWarningNamesBothFocalLengths) {
  EXPECT_THAT(focal_warning({0.8, 0.01}, without_distortion()),
              AllOf(HasSubstr("420 px"), HasSubstr("525 px of `camera`"), HasSubstr("holdfast calibrate")));
  EXPECT_EQ(focal_warning({1.05, 0.001}, without_distortion()), "") << "cameras differ by a few percent";
  EXPECT_EQ(focal_warning({0.8, 0.05}, without_distortion()), "") << "people who walk may be the cause";
}

}  // namespace
}  // namespace holdfast
