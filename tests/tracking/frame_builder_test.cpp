// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/frame_builder.hpp"

#include <gtest/gtest.h>

#include "holdfast/core/error.hpp"
#include "holdfast/tracking/image_depth.hpp"
#include "holdfast/tracking/no_depth.hpp"
#include "holdfast/tracking/pair_depth.hpp"
#include "support/point_world.hpp"

namespace holdfast {
namespace {

class KnownCamera : public testing::TestWithParam<std::string> {};

TEST_P(KnownCamera, TableUndistortsLikeTheCamera) {
  const Camera camera = find_camera(GetParam()).value();
  const UndistortionTable table(camera);
  Random random(2);
  std::vector<float> x, y, out_x, out_y;
  for (int i = 0; i < 5000; ++i) {
    x.push_back(static_cast<float>(random.uniform(0, camera.width - 1)));
    y.push_back(static_cast<float>(random.uniform(0, camera.height - 1)));
  }
  table.undistort(x, y, out_x, out_y);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Eigen::Vector2d exact = camera.undistort({x[i], y[i]});
    ASSERT_LT((exact - Eigen::Vector2d(out_x[i], out_y[i])).norm(), 5e-3) << x[i] << " " << y[i];
  }
}
INSTANTIATE_TEST_SUITE_P(All, KnownCamera, testing::ValuesIn(camera_names()));

TEST(FrameBuilder, NothingIsExtractedWhereAFisheyeImageIsNotUsable) {
  /// A feature in the middle of the image and one in its corner, where they are not ignored.
  class TwoFeatures final : public FeatureExtractor {
   public:
    void extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) override {
      const cv::Point places[] = {{grey.cols / 2, grey.rows / 2}, {3, 3}};
      out.resize(0);
      for (const cv::Point& place : places) {
        if (!ignore.empty() && ignore.at<std::uint8_t>(place) != 0) continue;
        out.resize(out.size() + 1);
        out.x.back() = static_cast<float>(place.x), out.y.back() = static_cast<float>(place.y);
      }
    }
    const ScalePyramid& pyramid() const override { return pyramid_; }

   private:
    ScalePyramid pyramid_{8, 1.2};
  };
  Camera camera;
  camera.fx = camera.fy = 220.0;  // the corner is 104 degrees from the axis
  TwoFeatures extractor;
  SensorFrame sensor_frame;
  sensor_frame.colour = cv::Mat(camera.height, camera.width, CV_8UC3, cv::Scalar::all(90));
  Frame frame;
  StageTimes times;
  const auto found = [&](const cv::Mat& ignore) {
    ImageDepth depth(camera, 0.0);
    FrameBuilder builder(camera, extractor, depth);
    builder.begin(sensor_frame, frame, times);
    builder.find_features(sensor_frame, ignore, frame, times);
    return frame.size();
  };
  cv::Mat middle(camera.height, camera.width, CV_8UC1, cv::Scalar(0));
  middle(cv::Rect(300, 220, 40, 40)) = 255;
  EXPECT_EQ(found({}), 2U);
  EXPECT_EQ(found(middle), 1U);
  camera.distortion.lens = Lens::fisheye;
  ASSERT_EQ(found({}), 1U);
  EXPECT_NEAR(frame.x[0], 320.0F, 0.5F);
  EXPECT_EQ(found(middle), 0U);
}

TEST(FrameBuilder, FeaturesLieWhereTheWorldIs) {
  test::PointWorld world(find_camera("tum_fr1").value());
  test::PointExtractor extractor(world);
  ImageDepth depth(world.camera(), 0.0);
  FrameBuilder builder(world.camera(), extractor, depth);
  Frame frame;
  StageTimes times;
  builder.build(world.frame(4, 2.5, Eigen::Isometry3d::Identity()), frame, times);
  EXPECT_EQ(frame.index, 4U);
  EXPECT_EQ(frame.timestamp, 2.5);
  ASSERT_GT(frame.size(), 500U);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    ASSERT_TRUE(frame.has_depth(i));
    const Eigen::Vector2d raw = world.camera().distort(world.camera().project(frame.camera_point(i)));
    EXPECT_NEAR(raw.x(), frame.features.x[i], 0.01);
    EXPECT_NEAR(raw.y(), frame.features.y[i], 0.01);
    EXPECT_NEAR(frame.right_x[i], world.camera().right_x(frame.x[i], frame.depth[i]), 1e-3);
    EXPECT_FALSE(frame.map_points[i].valid());
    EXPECT_EQ(frame.static_probability[i], 1.0F);
  }
}

TEST(FrameBuilder, AGreyImageIsTakenAsItIs) {
  test::PointWorld world(Camera{});
  test::PointExtractor extractor(world);
  ImageDepth depth(world.camera(), 0.0);
  FrameBuilder builder(world.camera(), extractor, depth);
  Frame frame;
  StageTimes times;
  SensorFrame sensor_frame = world.frame(0, 0.0, Eigen::Isometry3d::Identity());
  const cv::Mat grey(world.camera().height, world.camera().width, CV_8UC1, cv::Scalar(7));
  sensor_frame.colour = grey;
  builder.begin(sensor_frame, frame, times);
  EXPECT_EQ(builder.grey().data, grey.data);
  sensor_frame.colour = cv::Mat(grey.size(), CV_8UC3, cv::Scalar::all(200));
  builder.begin(sensor_frame, frame, times);
  EXPECT_EQ(builder.grey().at<std::uint8_t>(100, 100), 200);
  EXPECT_EQ(grey.at<std::uint8_t>(100, 100), 7) << "the caller may still look at it";
  sensor_frame.colour = cv::Mat(grey.size(), CV_16UC1, cv::Scalar(7));
  EXPECT_THROW(builder.begin(sensor_frame, frame, times), InputError);
}

TEST(FrameBuilder, ARightImageIsNotWrittenToAndMustFit) {
  test::PointWorld world(Camera{});
  test::PointExtractor extractor(world);
  PairDepth depth(world.camera(), {});
  FrameBuilder builder(world.camera(), extractor, depth);
  const cv::Size size(world.camera().width, world.camera().height);
  Frame frame;
  StageTimes times;
  SensorFrame grey = world.frame(0, 0.0, Eigen::Isometry3d::Identity());
  grey.right = cv::Mat(size, CV_8UC1, cv::Scalar(7));
  builder.begin(grey, frame, times);
  SensorFrame colour = world.frame(1, 0.1, Eigen::Isometry3d::Identity());
  colour.right = cv::Mat(size, CV_8UC3, cv::Scalar::all(200));
  builder.begin(colour, frame, times);
  EXPECT_EQ(grey.right.at<std::uint8_t>(100, 100), 7) << "the caller may still look at it";

  colour.right = cv::Mat(size / 2, CV_8UC1, cv::Scalar(7));
  EXPECT_THROW(builder.begin(colour, frame, times), InputError);
  colour.right.release();
  EXPECT_THROW(builder.begin(colour, frame, times), InputError);
}

TEST(FrameBuilder, WithoutDepthNothingHasDepth) {
  test::PointWorld world(Camera{});
  test::PointExtractor extractor(world);
  SensorFrame sensor_frame = world.frame(0, 0.0, Eigen::Isometry3d::Identity());
  sensor_frame.depth.release();
  ImageDepth image(world.camera(), 0.0);
  NoDepth none;
  for (DepthProvider* depth : {static_cast<DepthProvider*>(&image), static_cast<DepthProvider*>(&none)}) {
    Frame frame;
    StageTimes times;
    FrameBuilder(world.camera(), extractor, *depth).build(sensor_frame, frame, times);
    ASSERT_GT(frame.size(), 0U);
    for (std::size_t i = 0; i < frame.size(); ++i) {
      EXPECT_FALSE(frame.has_depth(i));
      EXPECT_TRUE(std::isnan(frame.right_x[i]));
    }
  }
}

TEST(FrameBuilder, DepthAtAnEdgeIsNotTrustedWhenAsked) {
  test::PointWorld world(Camera{});
  test::PointExtractor extractor(world);
  SensorFrame sensor_frame = world.frame(0, 0.0, Eigen::Isometry3d::Identity());
  sensor_frame.depth.setTo(2.0F);
  sensor_frame.depth.colRange(320, 640).setTo(3.0F);
  StageTimes times;
  Frame careful, trusting;
  ImageDepth careful_depth(world.camera(), 0.05), trusting_depth(world.camera(), 0.0);
  FrameBuilder(world.camera(), extractor, careful_depth).build(sensor_frame, careful, times);
  FrameBuilder(world.camera(), extractor, trusting_depth).build(sensor_frame, trusting, times);
  int at_edge = 0;
  for (std::size_t i = 0; i < careful.size(); ++i) {
    const bool edge = std::abs(careful.features.x[i] - 319.5F) < 1.9F;
    at_edge += edge ? 1 : 0;
    EXPECT_EQ(careful.has_depth(i), !edge) << careful.features.x[i];
    EXPECT_TRUE(trusting.has_depth(i));
  }
  EXPECT_GT(at_edge, 0);
}

TEST(FrameBuilder, WrongSizesNameBothSizes) {
  test::PointWorld world(Camera{});
  test::PointExtractor extractor(world);
  ImageDepth depth(world.camera(), 0.0);
  FrameBuilder builder(world.camera(), extractor, depth);
  SensorFrame sensor_frame = world.frame(3, 0.0, Eigen::Isometry3d::Identity());
  sensor_frame.colour = cv::Mat::zeros(100, 120, CV_8UC3);
  Frame frame;
  StageTimes times;
  try {
    builder.build(sensor_frame, frame, times);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("frame 3"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("120x100"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("640x480"), std::string::npos);
  }
}

}  // namespace
}  // namespace holdfast
