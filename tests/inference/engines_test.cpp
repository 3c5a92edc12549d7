// SPDX-License-Identifier: BSD-3-Clause
// Both engines compute the same. In builds without oneDNN: what its absence says.
#include <gmock/gmock.h>

#include <array>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <thread>

#include "holdfast/core/error.hpp"
#include "holdfast/inference/network.hpp"

namespace holdfast {
namespace {

using testing::HasSubstr;

NetworkOptions options(const std::string& name, NetworkEngine engine,
                       NetworkPrecision precision = NetworkPrecision::fp32) {
  NetworkOptions result;
  result.model = std::string(HOLDFAST_TEST_MODELS) + "/" + name + ".onnx";
  result.engine = engine;
  result.precision = precision;
  return result;
}

template <class Run>
std::string error_of(Run&& run) {
  try {
    run();
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

TEST(Engines, OpencvKnowsOnePrecision) {
  EXPECT_THAT(error_of([] { Network{options("logits", NetworkEngine::opencv, NetworkPrecision::bf16)}; }),
              HasSubstr("precision: found bf16 with `engine: opencv`, which computes in fp32 only"));
}

#if defined(HOLDFAST_ONEDNN)

cv::Mat picture(int width, int height, std::uint64_t seed = 1) {
  cv::Mat colour(height, width, CV_8UC3);
  cv::RNG(seed).fill(colour, cv::RNG::UNIFORM, 0, 256);
  return colour;
}

double difference(const cv::Mat& a, const cv::Mat& b) {
  EXPECT_EQ(std::vector<int>(a.size.p, a.size.p + a.dims), std::vector<int>(b.size.p, b.size.p + b.dims));
  return cv::norm(a, b, cv::NORM_INF);
}

bool has_bf16() {
  try {
    const Network network(options("logits", NetworkEngine::onednn, NetworkPrecision::bf16));
    return true;
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("AVX512_BF16"));
    return false;
  }
}

class EveryLayer : public testing::TestWithParam<int> {};

TEST_P(EveryLayer, GivesTheSameNumbersWithBothEngines) {
  NetworkOptions with_opencv = options("every_layer", NetworkEngine::opencv);
  with_opencv.width = GetParam();
  with_opencv.height = GetParam() == 16 ? 12 : 20;
  NetworkOptions with_onednn = with_opencv;
  with_onednn.engine = NetworkEngine::onednn;
  const cv::Mat colour = picture(with_opencv.width, with_opencv.height);
  Network opencv(with_opencv), onednn(with_onednn);
  const cv::Mat expected = opencv.run(colour).clone();
  EXPECT_GT(cv::norm(expected, cv::NORM_INF), 0.1);
  EXPECT_LT(difference(onednn.run(colour), expected), 1e-5);
  EXPECT_LT(difference(onednn.run_mirrored(), opencv.run_mirrored()), 1e-5);
}
INSTANTIATE_TEST_SUITE_P(Widths, EveryLayer, testing::Values(16, 64, 100));

TEST(Engines, GiveTheSameForTheModelsThatBothKnow) {
  for (const char* name : {"logits", "probabilities", "coarse", "one_channel"}) {
    Network opencv(options(name, NetworkEngine::opencv)), onednn(options(name, NetworkEngine::onednn));
    const cv::Mat colour = picture(16, 12);
    EXPECT_LT(difference(onednn.run(colour), opencv.run(colour)), 1e-5) << name;
  }
}

TEST(Engines, OnlyWhatTheNamedOutputNeedsIsComputed) {
  for (const char* output : {"scores", "shares"}) {
    NetworkOptions with_opencv = options("two_outputs", NetworkEngine::opencv);
    with_opencv.output_name = output;
    NetworkOptions with_onednn = with_opencv;
    with_onednn.engine = NetworkEngine::onednn;
    const cv::Mat colour = picture(16, 12);
    Network opencv(with_opencv), onednn(with_onednn);
    EXPECT_LT(difference(onednn.run(colour), opencv.run(colour)), 1e-5) << output;
  }
}

TEST(Engines, Bf16IsNear) {
  if (!has_bf16()) GTEST_SKIP() << "this processor has no bf16";
  NetworkOptions chosen = options("every_layer", NetworkEngine::onednn);
  chosen.width = 64;
  chosen.height = 48;
  const cv::Mat colour = picture(64, 48);
  Network full(chosen);
  chosen.precision = NetworkPrecision::bf16;
  Network half(chosen);
  const cv::Mat expected = full.run(colour), found = half.run(colour);
  EXPECT_GT(difference(found, expected), 0.0);
  EXPECT_LT(difference(found, expected), 0.05 * cv::norm(expected, cv::NORM_INF));
}

TEST(Engines, OnednnRepeatsItself) {
  NetworkOptions chosen = options("every_layer", NetworkEngine::onednn);
  chosen.width = 64;
  chosen.height = 48;
  for (const int threads : {0, 2}) {
    chosen.threads = threads;
    Network first(chosen), second(chosen);
    const cv::Mat expected = first.run(picture(64, 48)).clone();
    second.run(picture(64, 48, 2));
    EXPECT_EQ(difference(second.run(picture(64, 48)), expected), 0.0);
    EXPECT_EQ(difference(first.run(picture(64, 48)), expected), 0.0);
  }
}

TEST(Engines, OnednnRunsInSeveralThreadsAtOnce) {
  NetworkOptions chosen = options("every_layer", NetworkEngine::onednn);
  chosen.width = 64;
  chosen.height = 48;
  std::vector<cv::Mat> expected;
  for (int i = 0; i < 4; ++i) expected.push_back(Network(chosen).run(picture(64, 48, i + 1)).clone());
  // Made here, run there; and made there.
  Network here(chosen);
  std::array<double, 2> worst = {0.0, 0.0};
  const auto work = [&](Network& network, double& result) {
    for (int i = 0; i < 40; ++i) {
      const auto which = static_cast<std::size_t>(i % 4);
      result = std::max(result, cv::norm(network.run(picture(64, 48, which + 1)), expected[which], cv::NORM_INF));
    }
  };
  std::thread one([&] { work(here, worst[0]); });
  std::thread other([&] {
    Network there(chosen);
    work(there, worst[1]);
  });
  one.join();
  other.join();
  EXPECT_EQ(worst[0], 0.0);
  EXPECT_EQ(worst[1], 0.0);
}

TEST(Engines, OnednnLoadsInTheBackground) {
  NetworkOptions file = options("every_layer", NetworkEngine::onednn);
  file.width = 64;
  file.height = 48;
  const cv::Mat expected = Network(file).run(picture(64, 48)).clone();
  std::ifstream stream(file.model, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  file.bytes = bytes;
  file.in_background = true;
  Network network(file);
  EXPECT_EQ(difference(network.run(picture(64, 48)), expected), 0.0);
  const Network never_run(file);
}

TEST(Engines, WhatOnednnDoesNotKnowNamesTheLayerAndTheOtherEngine) {
  const auto message = [](const char* name) {
    NetworkOptions chosen = options(name, NetworkEngine::onednn);
    chosen.channels_last = std::string(name) == "channels_last";
    return error_of([&] { Network(chosen).run(picture(16, 12)); });
  };
  EXPECT_THAT(message("labels"), HasSubstr("labels.onnx: has a layer 'labels_node' (ArgMax)"));
  EXPECT_THAT(message("channels_last"), HasSubstr("(Transpose) that the engine onednn does not know; it knows Add"));
  EXPECT_THAT(message("flat"), HasSubstr("`engine: opencv` may read it"));
  EXPECT_THAT(message("half"), HasSubstr("float16"));
  EXPECT_THAT(message("strange_layer"), HasSubstr("(Sorcery)"));
}

TEST(Engines, ASizeThatDoesNotFitSaysSo) {
  NetworkOptions chosen = options("every_layer", NetworkEngine::onednn);
  chosen.width = 18;  // half of it is odd: halved and doubled again it is another number
  chosen.height = 12;
  EXPECT_THAT(error_of([&] { Network(chosen).run(picture(18, 12)); }), HasSubstr("check width and height"));
}

#else

TEST(Engines, WithoutOnednnTheErrorSaysWhatToInstall) {
  EXPECT_THAT(
      error_of([] { Network{options("logits", NetworkEngine::onednn)}; }),
      testing::AllOf(HasSubstr("engine: found onednn"), HasSubstr("libdnnl-dev"), HasSubstr("HOLDFAST_ONEDNN")));
}

#endif

}  // namespace
}  // namespace holdfast
