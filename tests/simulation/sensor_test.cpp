// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <set>

namespace holdfast::simulation {
namespace {

const cv::Mat facing(480, 640, CV_32FC1, cv::Scalar(1.0));

cv::Mat flat(float z) { return cv::Mat(480, 640, CV_32FC1, cv::Scalar(z)); }

TEST(DepthSensor, NoiseHasTheDeviationOfNguyenEtAl) {
  const Camera camera;
  for (const bool quantisation : {false, true})
    for (const float z : {0.8F, 1.5F, 3.0F, 4.5F}) {
      DepthSensorSettings settings;
      settings.quantisation = quantisation;
      cv::Scalar mean, deviation;
      cv::meanStdDev(sense_depth(flat(z), facing, camera, settings, 5), mean, deviation);
      const double expected = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
      EXPECT_NEAR(deviation[0], expected, 0.06 * expected) << z << ' ' << quantisation;
      EXPECT_NEAR(mean[0], z, 0.04 * expected + 1e-4 * z * z) << z;
    }
}

TEST(DepthSensor, NoiseGrowsOnSurfacesSeenFlat) {
  const Camera camera;
  DepthSensorSettings settings;
  settings.holes = settings.quantisation = false;
  const double angle = 75.0 * std::acos(-1.0) / 180.0;
  cv::Scalar mean, deviation;
  cv::meanStdDev(sense_depth(flat(1.0F), facing * std::cos(angle), camera, settings, 5), mean, deviation);
  const double expected = 0.0012 + 0.0019 * 0.36 + 0.0001 * std::pow(angle / (std::acos(0.0) - angle), 2.0);
  EXPECT_NEAR(deviation[0], expected, 0.06 * expected);
}

TEST(DepthSensor, QuantisationGivesTheStepsOfAnEighthPixelOfDisparity) {
  DepthSensorSettings settings;
  settings.noise = 0.0;
  cv::Mat slope(480, 640, CV_32FC1);
  for (int y = 0; y < 480; ++y)
    for (int x = 0; x < 640; ++x) slope.at<float>(y, x) = 2.0F + 0.0005F * static_cast<float>(x);
  const cv::Mat sensed = sense_depth(slope, facing, Camera(), settings, 1);
  std::set<float> values;
  for (int x = 0; x < 640; ++x) {
    const float z = sensed.at<float>(100, x);
    ASSERT_NEAR(580.0 * 0.075 * 8.0 / z, std::round(580.0 * 0.075 * 8.0 / z), 1e-3);
    values.insert(z);
  }
  EXPECT_NEAR(static_cast<double>(values.size()), 348.0 / 2.0 - 348.0 / 2.32 + 1.0, 2.0);
}

TEST(DepthSensor, WithEverythingOffDepthIsUntouched) {
  const DepthSensorSettings off{0.0, false, false, 0.0, 100.0};
  const cv::Mat sensed = sense_depth(flat(1.2345F), facing * 0.01, Camera(), off, 1);
  EXPECT_EQ(cv::norm(sensed, flat(1.2345F), cv::NORM_INF), 0.0);
}

TEST(DepthSensor, HasNoValueOutOfRange) {
  EXPECT_EQ(cv::countNonZero(sense_depth(flat(0.3F), facing, Camera(), {}, 1)), 0);
  EXPECT_EQ(cv::countNonZero(sense_depth(flat(8.5F), facing, Camera(), {}, 1)), 0);
  EXPECT_EQ(cv::countNonZero(sense_depth(flat(0.0F), facing, Camera(), {}, 1)), 0);
}

TEST(DepthSensor, ShadowOfTheProjectorLiesLeftOfNearThings) {
  cv::Mat depth = flat(3.0F);
  depth(cv::Rect(200, 100, 100, 200)) = 1.0F;
  Camera camera;
  DepthSensorSettings settings;
  settings.noise = 0.0, settings.quantisation = false;
  const cv::Mat sensed = sense_depth(depth, facing, camera, settings, 1);
  const double width = camera.fx * 0.075 * (1.0 - 1.0 / 3.0);  // 26 px
  for (int x = 10; x < 630; ++x) {
    const float z = sensed.at<float>(200, x);
    const bool shadow = x > 200 - width + 1 && x < 199;
    const bool border = std::abs(x - (200 - width)) < 2 || std::abs(x - 199.5) < 2 || std::abs(x - 299.5) < 2;
    if (!border) {
      EXPECT_EQ(z == 0.0F, shadow) << x;
    }
  }
  settings.holes = false;
  EXPECT_EQ(cv::countNonZero(sense_depth(depth, facing, camera, settings, 1)), 640 * 480);
}

TEST(DepthSensor, DependsOnTheSeedAlone) {
  const cv::Mat one = sense_depth(flat(2.0F), facing, Camera(), {}, 1);
  EXPECT_EQ(cv::norm(one, sense_depth(flat(2.0F), facing, Camera(), {}, 1), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(one, sense_depth(flat(2.0F), facing, Camera(), {}, 2), cv::NORM_INF), 0.0);
}

TEST(ColourSensor, NoiseHasTheAskedDeviationAndNoBias) {
  const cv::Mat grey(480, 640, CV_8UC3, cv::Scalar(60, 120, 180));
  for (const double noise : {2.0, 5.0}) {
    cv::Mat noisy = grey.clone();
    add_colour_noise(noisy, {noise}, 4);
    cv::Scalar mean, deviation;
    cv::meanStdDev(noisy, mean, deviation);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(mean[c], 60.0 * (c + 1), 0.05);
      EXPECT_NEAR(deviation[c], std::hypot(noise, std::sqrt(1.0 / 12.0)), 0.03 * noise);
    }
  }
  cv::Mat untouched = grey.clone();
  add_colour_noise(untouched, {0.0}, 4);
  EXPECT_EQ(cv::norm(untouched, grey, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace holdfast::simulation
