// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/network.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>

#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

NetworkOptions options(const std::string& name) {
  NetworkOptions result;
  result.model = std::string(HOLDFAST_TEST_MODELS) + "/" + name + ".onnx";
  return result;
}

float output_at(const cv::Mat& output, int channel, int y, int x) {
  const int index[] = {0, channel, y, x};
  return output.at<float>(index);
}

TEST(Network, InputIsScaledByChannelInTheOrderAskedFor) {
  NetworkOptions chosen = options("logits");
  chosen.mean = {0.5, 0.25, 0.125};
  chosen.standard_deviation = {0.5, 2.0, 4.0};
  const cv::Mat colour(12, 16, CV_8UC3, cv::Scalar(10, 102, 204));  // blue green red
  for (const bool rgb : {true, false}) {
    chosen.rgb = rgb;
    Network network(chosen);
    EXPECT_EQ(network.input_text(), "1x3x12x16");
    const cv::Mat output = network.run(colour);
    const double first = ((rgb ? 204 : 10) / 255.0 - 0.5) / 0.5, second = (102 / 255.0 - 0.25) / 2.0;
    EXPECT_NEAR(output_at(output, 0, 3, 4), 1.0, 1e-5);
    EXPECT_NEAR(output_at(output, 1, 3, 4), 8.0 * (first - 0.5), 1e-4);
    EXPECT_NEAR(output_at(output, 2, 11, 15), 8.0 * (second - 0.5), 1e-4);
  }
}

TEST(Network, LoadedInTheBackgroundItGivesTheSame) {
  const cv::Mat colour(12, 16, CV_8UC3, cv::Scalar(10, 102, 204));
  const NetworkOptions file = options("logits");
  const cv::Mat expected = Network(file).run(colour).clone();
  std::ifstream stream(file.model, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  NetworkOptions background = file;
  background.bytes = bytes;
  background.in_background = true;
  Network network(background);
  EXPECT_EQ(network.input_text(), "1x3x12x16");
  for (int i = 0; i < 2; ++i) EXPECT_EQ(cv::norm(network.run(colour), expected, cv::NORM_INF), 0.0);
  const Network never_run(background);
}

TEST(Network, InTheBackgroundDeclarationsAreCheckedAtOnce) {
  const std::vector<std::uint8_t> bytes(100, 7);
  NetworkOptions background = options("logits");
  background.bytes = bytes;
  background.in_background = true;
  EXPECT_THROW(Network{background}, InputError);
  background.bytes = {};
  EXPECT_THROW(Network{background}, CheckError);
}

TEST(Network, ImagesOfAnySizeAreResized) {
  cv::Mat colour(480, 640, CV_8UC3, cv::Scalar(0, 0, 0));
  colour(cv::Rect(320, 0, 320, 480)).setTo(cv::Scalar(0, 0, 255));
  Network network(options("logits"));
  const cv::Mat output = network.run(colour);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 16; ++x) EXPECT_NEAR(output_at(output, 1, y, x), x < 8 ? -4.0 : 4.0, 1e-4) << x << ' ' << y;
}

TEST(Network, TheMirrorImageNeedsNoSecondPreparation) {
  cv::Mat colour(12, 16, CV_8UC3), mirror_image;
  cv::RNG(1).fill(colour, cv::RNG::UNIFORM, 0, 256);
  cv::flip(colour, mirror_image, 1);
  for (const char* model : {"logits", "channels_last"}) {
    NetworkOptions chosen = options(model);
    chosen.channels_last = std::string(model) == "channels_last";
    Network network(chosen);
    const cv::Mat expected = network.run(mirror_image).clone(), plain = network.run(colour).clone();
    const cv::Mat mirrored = network.run_mirrored();
    ASSERT_EQ(mirrored.total(), expected.total());
    EXPECT_TRUE(std::equal(expected.begin<float>(), expected.end<float>(), mirrored.begin<float>())) << model;
    EXPECT_FALSE(std::equal(expected.begin<float>(), expected.end<float>(), plain.begin<float>())) << model;
  }
}

TEST(Network, AFreeSizeIsTheOneThatIsAskedFor) {
  NetworkOptions chosen = options("any_size");
  chosen.width = 32;
  chosen.height = 20;
  Network network(chosen);
  const cv::Mat output = network.run(cv::Mat::zeros(48, 64, CV_8UC3));
  ASSERT_EQ(output.dims, 4);
  EXPECT_EQ(output.size[2], 20);
  EXPECT_EQ(output.size[3], 32);
}

TEST(Network, TheNamedOutputIsGiven) {
  NetworkOptions chosen = options("two_outputs");
  const cv::Mat colour(12, 16, CV_8UC3, cv::Scalar(0, 0, 255));
  chosen.output_name = "scores";
  EXPECT_NEAR(output_at(Network(chosen).run(colour), 1, 0, 0), 4.0, 1e-4);
  chosen.output_name = "shares";
  const double sum = std::exp(1.0) + std::exp(4.0) + std::exp(-4.0);
  EXPECT_NEAR(output_at(Network(chosen).run(colour), 1, 0, 0), std::exp(4.0) / sum, 1e-5);
}

}  // namespace
}  // namespace holdfast
