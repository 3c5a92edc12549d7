// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/camera.hpp"

#include <gtest/gtest.h>

namespace holdfast {
namespace {

class KnownCamera : public testing::TestWithParam<std::string> {};

TEST_P(KnownCamera, UndistortInvertsDistortOverTheWholeImage) {
  const Camera camera = find_camera(GetParam()).value();
  for (int row = 0; row < camera.height; row += 13)
    for (int column = 0; column < camera.width; column += 17) {
      const Eigen::Vector2d raw(column, row);
      const Eigen::Vector2d back = camera.distort(camera.undistort(raw));
      ASSERT_LT((back - raw).norm(), 1e-4) << column << " " << row;
    }
}

TEST_P(KnownCamera, BackProjectInvertsProject) {
  const Camera camera = find_camera(GetParam()).value();
  const Eigen::Vector3d point(0.3, -0.2, 1.7);
  const Eigen::Vector2d pixel = camera.project(point);
  EXPECT_TRUE(camera.back_project(pixel.x(), pixel.y(), 1.7).isApprox(point, 1e-12));
}

TEST_P(KnownCamera, BoundsHoldTheWholeImage) {
  const Camera camera = find_camera(GetParam()).value();
  Eigen::Vector2d minimum, maximum;
  camera.undistorted_bounds(minimum, maximum);
  for (int row = 0; row < camera.height; row += 7)
    for (int column = 0; column < camera.width; column += 7) {
      const Eigen::Vector2d pixel = camera.undistort({column, row});
      ASSERT_GE(pixel.x(), minimum.x() - 0.1);
      ASSERT_LE(pixel.x(), maximum.x() + 0.1);
      ASSERT_GE(pixel.y(), minimum.y() - 0.1);
      ASSERT_LE(pixel.y(), maximum.y() + 0.1);
    }
}

INSTANTIATE_TEST_SUITE_P(All, KnownCamera, testing::ValuesIn(camera_names()));

TEST(Camera, UnknownNameIsNothing) { EXPECT_FALSE(find_camera("tum_fr4")); }

}  // namespace
}  // namespace holdfast
