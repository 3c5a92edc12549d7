// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/dense_map/kept_view.hpp"

#include <gtest/gtest.h>

#include "dense_map/wall_world.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

using test::WallWorld;

CoarseView blank_coarse(const Camera& camera) {
  CoarseView coarse;
  coarse.grid = CoarseSampler(camera).grid();
  coarse.depth.assign(static_cast<std::size_t>(coarse.grid.size()), 1.0F);
  return coarse;
}

int count_moving(const KeptView& view) {
  int count = 0;
  for (int y = 0; y < view.depth.rows; ++y)
    for (int x = 0; x < view.depth.cols; ++x) count += view.moves(x, y) ? 1 : 0;
  return count;
}

TEST(KeptView, HasNoDistortionAndTheColourOfThePlace) {
  const WallWorld world(0.2);
  for (const int step : {1, 2, 3}) {
    DenseMapSettings settings;
    settings.step = step;
    const ViewSampler sampler(world.camera, settings);
    const KeptView view = sampler.sample({}, world.images(0.3, 7, std::nullopt), {}, {}, {});
    ASSERT_EQ(view.colour.cols, 160 / step);
    EXPECT_EQ(view.frame_index, 7U);
    int seen = 0;
    for (int y = 0; y < view.depth.rows; ++y)
      for (int x = 0; x < view.depth.cols; ++x) {
        if (view.depth_at(x, y) == 0.0) {
          EXPECT_TRUE(view.moves(x, y));  // outside the image
          continue;
        }
        ++seen;
        EXPECT_NEAR(view.depth_at(x, y), WallWorld::wall_z, KeptView::depth_unit);
        const Eigen::Vector3d point = sampler.camera().back_project(x, y, WallWorld::wall_z);
        const cv::Vec3b expected = WallWorld::wall_colour(0.3 + point.x(), point.y());
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(view.colour.at<cv::Vec3b>(y, x)[c], expected[c], 2) << x << " " << y;
      }
    EXPECT_GT(seen, view.depth.rows * view.depth.cols * 8 / 10);
  }
}

TEST(KeptView, SpreadsWhatMovesAtItsDepthOnly) {
  WallWorld world;
  DenseMapSettings settings;
  settings.step = 1;
  settings.dilate = 6;
  settings.edge = 1;
  const ViewSampler sampler(world.camera, settings);
  cv::Mat labels;
  SensorFrame frame = world.images(0.0, 0, 0.0, &labels);
  // The square spans columns 47 to 112. The mask misses its left end by 4 px; on the right depth is missing.
  labels.colRange(0, 52) = 0;
  frame.depth(cv::Rect(113, 55, 3, 10)) = 0.0F;
  const KeptView view = sampler.sample({}, frame, {}, labels, {false, true});
  EXPECT_TRUE(view.moves(80, 60));
  EXPECT_TRUE(view.moves(48, 60));    // the square's own depth
  EXPECT_FALSE(view.moves(45, 60));   // the wall beside it
  EXPECT_TRUE(view.moves(115, 60));   // no depth
  EXPECT_FALSE(view.moves(117, 60));  // the wall
  EXPECT_TRUE(view.moves(80, 92));    // the wall at the mask's edge; the square ends at row 91
  EXPECT_FALSE(view.moves(80, 93));
  EXPECT_NEAR(view.depth_at(80, 60), WallWorld::square_z, KeptView::depth_unit);
}

TEST(KeptView, TakesLabelsBeforeTheCoarseOnes) {
  const WallWorld world;
  DenseMapSettings settings;
  settings.dilate = settings.edge = 0;
  const ViewSampler sampler(world.camera, settings);
  const SensorFrame frame = world.images(0.0, 0, std::nullopt);
  CoarseView coarse = blank_coarse(world.camera);
  EXPECT_EQ(count_moving(sampler.sample({}, frame, coarse, {}, {false, true})), 0);
  coarse.mask.labels.assign(coarse.depth.size(), 0);
  coarse.mask.labels[static_cast<std::size_t>(coarse.grid.cell_of(40, 40))] = 1;
  coarse.mask.labels[static_cast<std::size_t>(coarse.grid.cell_of(80, 40))] = 255;
  coarse.mask.labels[static_cast<std::size_t>(coarse.grid.cell_of(120, 40))] = 2;
  const KeptView carried = sampler.sample({}, frame, coarse, {}, {false, true, false});
  EXPECT_TRUE(carried.moves(20, 20));
  EXPECT_TRUE(carried.moves(40, 20));  // unknown
  EXPECT_FALSE(carried.moves(60, 20));
  const cv::Mat clean = cv::Mat::zeros(120, 160, CV_8UC1);
  EXPECT_EQ(count_moving(sampler.sample({}, frame, coarse, clean, {false, true, false})), 0);
  coarse.static_log_odds.assign(coarse.depth.size(), 0.0F);
  coarse.static_log_odds[static_cast<std::size_t>(coarse.grid.cell_of(100, 80))] = -0.1F;
  const KeptView measured = sampler.sample({}, frame, coarse, clean, {false, true, false});
  EXPECT_TRUE(measured.moves(50, 40));
  EXPECT_EQ(count_moving(measured), 4);  // one cell of 4 x 4 px
}

TEST(KeptView, KeepsLabelsWhereAskedFor) {
  const WallWorld world;
  const SensorFrame frame = world.images(0.0, 0, std::nullopt);
  const CoarseView coarse = blank_coarse(world.camera);
  cv::Mat labels = cv::Mat::zeros(120, 160, CV_8UC1);
  labels.colRange(80, 160).setTo(3);
  EXPECT_TRUE(ViewSampler(world.camera, {}).sample({}, frame, coarse, labels, {}).labels.empty());
  const ViewSampler sampler(world.camera, {}, true);
  EXPECT_TRUE(sampler.sample({}, frame, coarse, {}, {}).labels.empty()) << "there is no mask";
  const KeptView view = sampler.sample({}, frame, coarse, labels, {});
  ASSERT_EQ(view.labels.size(), view.depth.size());
  EXPECT_EQ(view.labels.at<std::uint8_t>(30, 20), 0);
  EXPECT_EQ(view.labels.at<std::uint8_t>(30, 60), 3);
}

TEST(KeptView, HasThePoseOfTheDepthImage) {
  const WallWorld world;
  const ViewSampler sampler(world.camera, {});
  SensorFrame frame = world.images(0.0, 0, std::nullopt);
  CoarseView coarse = blank_coarse(world.camera);
  coarse.T_view_camera.translation().x() = 0.02;
  EXPECT_EQ(sampler.sample({}, frame, coarse, {}, {}).T_view_keyframe.translation().x(), 0.0) << "exposed together";
  frame.depth_delay = -0.015;
  const KeptView view = sampler.sample({}, frame, coarse, {}, {});
  EXPECT_EQ(view.T_view_keyframe.translation().x(), 0.02);
  Eigen::Isometry3d T_keyframe_world = Eigen::Isometry3d::Identity();
  T_keyframe_world.translation().x() = 1.0;
  EXPECT_NEAR(view.T_world_view(T_keyframe_world).translation().x(), -1.02, 1e-12);
}

TEST(KeptView, RefusesImagesOfAnotherSize) {
  const WallWorld world;
  const ViewSampler sampler(world.camera, {});
  SensorFrame frame = world.images(0.0, 0, std::nullopt);
  EXPECT_THROW(sampler.sample({}, frame, {}, cv::Mat::zeros(60, 80, CV_8UC1), {}), CheckError);
  frame.colour = frame.colour.colRange(0, 80);
  EXPECT_THROW(sampler.sample({}, frame, {}, {}, {}), CheckError);
}

}  // namespace
}  // namespace holdfast
