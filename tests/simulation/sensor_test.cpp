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
  const DepthSensorSettings off{0.0, false, false, 0.0, 100.0, 0.0, 0.0};
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
  settings.noise = 0.0, settings.quantisation = false, settings.edge_holes = 0.0;
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

// A square at 1.5 m before a wall at 2 m.
cv::Mat one_square() {
  cv::Mat depth = flat(2.0F);
  depth(cv::Rect(200, 120, 240, 240)) = 1.5F;
  return depth;
}

DepthSensorSettings edges_alone(double width) {
  DepthSensorSettings settings;
  settings.noise = 0.0, settings.quantisation = settings.holes = false, settings.edge_holes = width;
  return settings;
}

cv::Mat holes_of(const DepthSensorSettings& settings, std::uint64_t seed, double time) {
  return sense_depth(one_square(), facing, Camera(), settings, seed, time) == 0.0F;
}

TEST(DepthSensor, HolesAtEdgesAreAsWideAsAskedAndVaryAlongTheEdge) {
  for (const double width : {1.0, 2.0, 4.0}) {
    const cv::Mat holes = holes_of(edges_alone(width), 3, 0.5);
    const auto reach = static_cast<int>(width);
    // None away from the edges, within the square or without.
    EXPECT_EQ(cv::countNonZero(holes(cv::Rect(200 + reach, 120 + reach, 240 - 2 * reach, 240 - 2 * reach))), 0);
    cv::Mat outside = holes.clone();
    outside(cv::Rect(200 - reach, 120 - reach, 240 + 2 * reach, 240 + 2 * reach)) = 0;
    EXPECT_EQ(cv::countNonZero(outside), 0);
    std::set<int> widths;
    for (int y = 140; y < 340; ++y) widths.insert(cv::countNonZero(holes(cv::Rect(190, y, 20, 1))));
    EXPECT_GE(widths.size(), 3U) << width;
    EXPECT_GT(cv::countNonZero(holes), 0.5 * width * 4 * 240) << width;
  }
  EXPECT_EQ(cv::countNonZero(holes_of(edges_alone(0.0), 3, 0.5)), 0);
}

TEST(DepthSensor, HolesAtEdgesRollOnSlowly) {
  const DepthSensorSettings settings = edges_alone(4.0);
  const auto difference = [&](double from, double to) {
    return cv::countNonZero(holes_of(settings, 3, from) != holes_of(settings, 3, to));
  };
  for (const double time : {0.1, 0.7, 3.3}) {
    EXPECT_EQ(difference(time, time), 0);  // in any order
    const int soon = difference(time, time + 1.0 / 30.0), late = difference(time, time + 1.0);
    EXPECT_GT(soon, 0);
    EXPECT_GT(late, 1.3 * soon) << time;
  }
  EXPECT_GT(cv::countNonZero(holes_of(settings, 3, 0.1) != holes_of(settings, 4, 0.1)), 100);
}

TEST(DepthSensor, DropoutLosesTheAskedShareAnewInEachFrame) {
  DepthSensorSettings settings = edges_alone(0.0);
  settings.dropout = 0.05;
  const cv::Mat one = sense_depth(flat(2.0F), facing, Camera(), settings, 1, 0.0);
  EXPECT_NEAR(cv::countNonZero(one == 0.0F) / (640.0 * 480.0), 0.05, 0.002);
  const cv::Mat other = sense_depth(flat(2.0F), facing, Camera(), settings, 1, 0.1);
  EXPECT_NEAR(cv::countNonZero((one == 0.0F) & (other == 0.0F)) / (640.0 * 480.0), 0.0025, 0.0005);
  settings.dropout = 1.0;
  EXPECT_EQ(cv::countNonZero(sense_depth(flat(2.0F), facing, Camera(), settings, 1)), 0);
}

TEST(DepthSensor, DependsOnTheSeedAndTheTimeAlone) {
  const cv::Mat one = sense_depth(flat(2.0F), facing, Camera(), {}, 1);
  EXPECT_EQ(cv::norm(one, sense_depth(flat(2.0F), facing, Camera(), {}, 1), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(one, sense_depth(flat(2.0F), facing, Camera(), {}, 2), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(one, sense_depth(flat(2.0F), facing, Camera(), {}, 1, 0.5), cv::NORM_INF), 0.0);
}

TEST(ColourSensor, NoiseHasTheAskedDeviationAndNoBias) {
  const cv::Mat grey(480, 640, CV_8UC3, cv::Scalar(60, 120, 180));
  for (const double noise : {2.0, 5.0}) {
    cv::Mat noisy = grey.clone();
    sense_colour(noisy, {noise}, 4);
    cv::Scalar mean, deviation;
    cv::meanStdDev(noisy, mean, deviation);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(mean[c], 60.0 * (c + 1), 0.05);
      EXPECT_NEAR(deviation[c], std::hypot(noise, std::sqrt(1.0 / 12.0)), 0.03 * noise);
    }
  }
  cv::Mat untouched = grey.clone();
  sense_colour(untouched, {0.0}, 4);
  EXPECT_EQ(cv::norm(untouched, grey, cv::NORM_INF), 0.0);
}

TEST(ColourSensor, GainScalesLightAndClips) {
  const cv::Mat grey(480, 640, CV_8UC3, cv::Scalar(60, 120, 180));
  cv::Mat bright = grey.clone();
  sense_colour(bright, {0.0}, 1, 0.0, 1.5);
  EXPECT_EQ(bright.at<cv::Vec3b>(7, 9), cv::Vec3b(90, 180, 255));
  // With the light out the noise remains, clipped at black.
  cv::Mat dark = grey.clone();
  sense_colour(dark, {2.0}, 1, 0.0, 0.01);
  const cv::Scalar mean = cv::mean(dark);
  EXPECT_LT(mean[2], 3.0);
  EXPECT_GT(mean[0], 0.5);
  EXPECT_GT(cv::norm(dark, cv::NORM_INF), 4.0);
}

TEST(ColourSensor, ExposureWandersSmoothlyWithinItsBounds) {
  ColourSensorSettings settings;
  settings.noise = 0.0, settings.exposure_change = 0.5, settings.exposure_period = 4.0;
  double least = 9.0, most = 0.0;
  for (int i = 0; i < 900; ++i) {
    const double gain = exposure_gain(settings, 7, i / 30.0), next = exposure_gain(settings, 7, (i + 1) / 30.0);
    EXPECT_LT(std::abs(next - gain), 0.04) << i;
    least = std::min(least, gain), most = std::max(most, gain);
  }
  EXPECT_GE(least, 1.0 / 1.5);
  EXPECT_LE(most, 1.5);
  EXPECT_LT(least, 0.75);
  EXPECT_GT(most, 1.35);
  EXPECT_NE(exposure_gain(settings, 7, 1.0), exposure_gain(settings, 8, 1.0));
  cv::Mat image(8, 8, CV_8UC3, cv::Scalar::all(100));
  sense_colour(image, settings, 7, 2.0);
  EXPECT_NEAR(image.at<cv::Vec3b>(4, 4)[1], 100.0 * exposure_gain(settings, 7, 2.0), 0.51);
  settings.exposure_change = 0.0;
  EXPECT_EQ(exposure_gain(settings, 7, 1.0), 1.0);
}

TEST(ColourSensor, VignettingDarkensTheCorners) {
  ColourSensorSettings settings;
  settings.noise = 0.0, settings.vignetting = 0.4;
  cv::Mat image(481, 641, CV_8UC3, cv::Scalar::all(200));
  sense_colour(image, settings, 1);
  EXPECT_EQ(image.at<cv::Vec3b>(240, 320)[0], 200);
  EXPECT_NEAR(image.at<cv::Vec3b>(0, 0)[0], 120, 1);
  EXPECT_NEAR(image.at<cv::Vec3b>(480, 640)[2], 120, 1);
  EXPECT_NEAR(image.at<cv::Vec3b>(240, 640)[1], 200 * (1 - 0.4 * 320.0 * 320.0 / (320.0 * 320.0 + 240.0 * 240.0)), 1);
}

TEST(ColourSensor, DependsOnTheSeedAndTheTimeAlone) {
  const auto frame = [](std::uint64_t seed, double time) {
    cv::Mat image(480, 640, CV_8UC3, cv::Scalar::all(100));
    sense_colour(image, {2.0, 0.3, 4.0, 0.2}, seed, time, 0.8);
    return image;
  };
  EXPECT_EQ(cv::norm(frame(1, 0.5), frame(1, 0.5), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(frame(1, 0.5), frame(2, 0.5), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(frame(1, 0.5), frame(1, 0.6), cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace holdfast::simulation
