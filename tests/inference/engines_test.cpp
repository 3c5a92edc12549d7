// SPDX-License-Identifier: BSD-3-Clause
// All engines compute the same. In builds without oneDNN, and without ONNX Runtime: what its absence says.
#include <gmock/gmock.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <optional>
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

cv::Mat picture(int width, int height, std::uint64_t seed = 1) {
  cv::Mat colour(height, width, CV_8UC3);
  cv::RNG(seed).fill(colour, cv::RNG::UNIFORM, 0, 256);
  return colour;
}

double difference(const cv::Mat& a, const cv::Mat& b) {
  EXPECT_EQ(std::vector<int>(a.size.p, a.size.p + a.dims), std::vector<int>(b.size.p, b.size.p + b.dims));
  return cv::norm(a, b, cv::NORM_INF);
}

class Onnxruntime : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_onnxruntime()) GTEST_SKIP() << "no ONNX Runtime: sh cmake/install_dependencies.sh --onnxruntime";
  }
  static NetworkOptions of(const std::string& name) { return options(name, NetworkEngine::onnxruntime); }
};

TEST_F(Onnxruntime, GivesTheSameAsOpencv) {
  for (const char* name : {"logits", "probabilities", "coarse", "one_channel"}) {
    Network opencv(options(name, NetworkEngine::opencv)), onnxruntime(of(name));
    const cv::Mat colour = picture(16, 12);
    EXPECT_LT(difference(onnxruntime.run(colour), opencv.run(colour)), 1e-5) << name;
    EXPECT_LT(difference(onnxruntime.run_mirrored(), opencv.run_mirrored()), 1e-5) << name;
  }
  for (const int width : {16, 100}) {
    NetworkOptions with_opencv = options("every_layer", NetworkEngine::opencv);
    with_opencv.width = width, with_opencv.height = 20;
    NetworkOptions chosen = with_opencv;
    chosen.engine = NetworkEngine::onnxruntime, chosen.threads = width == 16 ? 1 : 2;
    Network opencv(with_opencv), onnxruntime(chosen);
    EXPECT_LT(difference(onnxruntime.run(picture(width, 20)), opencv.run(picture(width, 20))), 1e-5);
  }
}

TEST_F(Onnxruntime, GivesAndTakesTheNumbersOfTheNetworkAsFloats) {
  const cv::Mat colour = picture(16, 12);
  const cv::Mat expected = Network(options("logits", NetworkEngine::opencv)).run(colour).clone();
  EXPECT_LT(difference(Network(of("half")).run(colour), expected), 0.02);
  NetworkOptions bytes = of("quantised");
  bytes.scale = 1.0;
  EXPECT_LT(difference(Network(bytes).run(colour), expected), 1e-4);
  const cv::Mat labels = Network(options("labels", NetworkEngine::opencv)).run(colour).clone();
  EXPECT_EQ(difference(Network(of("labels")).run(colour), labels), 0.0);
}

TEST_F(Onnxruntime, RunsOperatorsAndSizesThatOpencvDoesNot) {
  NetworkOptions chosen = of("opset_17");
  chosen.width = 31, chosen.height = 21;
  Network network(chosen);
  const cv::Mat scores = network.run(picture(31, 21));
  EXPECT_EQ(std::vector<int>(scores.size.p, scores.size.p + scores.dims), (std::vector<int>{1, 3, 21, 31}));
  EXPECT_THAT(network.engine_text(), testing::AllOf(HasSubstr("ONNX Runtime 1."), HasSubstr("provider cpu")));
}

TEST_F(Onnxruntime, ErrorsSayWhatIsThere) {
  EXPECT_THAT(error_of([] { Network{of("strange_layer")}; }),
              testing::AllOf(HasSubstr("cannot be run by ONNX Runtime 1."), HasSubstr("Sorcery")));
  NetworkOptions chosen = of("logits");
  chosen.provider = "abacus";
  EXPECT_THAT(error_of([&] { Network{chosen}; }),
              testing::AllOf(HasSubstr("provider: found 'abacus'"), HasSubstr("has "), HasSubstr("cpu")));
  EXPECT_THAT(error_of([] { Network{options("logits", NetworkEngine::onnxruntime, NetworkPrecision::bf16)}; }),
              HasSubstr("with `engine: onnxruntime`, which computes with the numbers of the file"));
}

/// The environment variable that names a library of ONNX Runtime, for one test.
class NamedLibrary {
 public:
  explicit NamedLibrary(const std::string& file) {
    if (const char* value = std::getenv(name)) before_ = value;
    setenv(name, file.c_str(), 1);
  }
  ~NamedLibrary() { before_ ? setenv(name, before_->c_str(), 1) : unsetenv(name); }
  NamedLibrary(const NamedLibrary&) = delete;
  NamedLibrary& operator=(const NamedLibrary&) = delete;

 private:
  static constexpr const char* name = "HOLDFAST_ONNXRUNTIME";
  std::optional<std::string> before_;
};

TEST(OnnxruntimeLibrary, OneThatCannotBeUsedIsAnErrorThatSaysWhy) {
  const auto error = [](const std::string& library) {
    const NamedLibrary named(library);
    return error_of([] { Network{options("logits", NetworkEngine::onnxruntime)}; });
  };
  EXPECT_THAT(error("/absent/libonnxruntime.so"),
              testing::AllOf(HasSubstr("engine: found onnxruntime, but `HOLDFAST_ONNXRUNTIME` names "
                                       "/absent/libonnxruntime.so, which does not exist"),
                             HasSubstr("install_dependencies.sh --onnxruntime"), HasSubstr("`engine_library`")));
  EXPECT_THAT(error(HOLDFAST_TEST_MODELS), HasSubstr("in which there is no libonnxruntime.so"));
  EXPECT_THAT(error(HOLDFAST_TEST_MODELS "/logits.onnx"), HasSubstr("its library cannot be loaded"));
  EXPECT_THAT(error("none"), HasSubstr("HOLDFAST_ONNXRUNTIME is 'none'; unset it"));
  EXPECT_THAT(error(HOLDFAST_OTHER_LIBRARY), HasSubstr("is another library, without OrtGetApiBase"));
  EXPECT_THAT(error(HOLDFAST_OLD_ONNXRUNTIME), HasSubstr("is version 1.7.2; expected version 1.12 or later"));
}

TEST(OnnxruntimeLibrary, AutoDoesWithoutAndANamedOneIsTaken) {
  const NamedLibrary named("none");
  EXPECT_EQ(chosen_engine({}, false), NetworkEngine::opencv);
  EXPECT_EQ(chosen_engine({}, true), has_onednn() ? NetworkEngine::onednn : NetworkEngine::opencv);
  EXPECT_EQ(chosen_engine({.provider = "cuda"}, true), NetworkEngine::onnxruntime);
  EXPECT_EQ(chosen_engine({.engine_library = "/opt/it.so"}, false), NetworkEngine::onnxruntime);
  EXPECT_THAT(error_of([] { chosen_engine({.engine = NetworkEngine::opencv, .provider = "cuda"}, false); }),
              HasSubstr("provider: found 'cuda' with `engine: opencv`"));
}

TEST_F(Onnxruntime, IsTheChoiceOfAutoWhereItIsFoundButForOnednnsNetworks) {
  EXPECT_EQ(chosen_engine({}, false), NetworkEngine::onnxruntime);
  EXPECT_EQ(chosen_engine({}, true), has_onednn() ? NetworkEngine::onednn : NetworkEngine::onnxruntime);
}

#if defined(HOLDFAST_ONEDNN)

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
