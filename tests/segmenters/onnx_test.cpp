// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>

#include "holdfast/inference/network.hpp"
#include "segmenters/segmenter_fixture.hpp"

extern "C" void holdfast_register_plugin_onnx(holdfast::Registry& registry);

namespace holdfast {
namespace {

using test::error_of;
using test::frame_of;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

const std::vector<std::string> three = {"background", "person", "chair"};

std::unique_ptr<Segmenter> make(const std::string& model, ParameterValues values = {}) {
  values["model"] = std::string(HOLDFAST_TEST_MODELS) + "/" + model + ".onnx";
  values.try_emplace("classes", three);
  values.try_emplace("engine", "opencv");
  testing::internal::CaptureStderr();
  struct Silence {
    ~Silence() { EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "a library printed"; }
  } silence;
  return test::make_segmenter(holdfast_register_plugin_onnx, "onnx", values);
}

/// Left black, middle red (person), right green (chair).
SensorFrame stripes() {
  SensorFrame frame = frame_of(1.0, 640, 480);
  frame.colour(cv::Rect(240, 0, 200, 480)).setTo(cv::Scalar(0, 0, 255));
  frame.colour(cv::Rect(440, 0, 200, 480)).setTo(cv::Scalar(0, 255, 0));
  return frame;
}

void expect_stripes(Segmenter& segmenter, int person = 1, int chair = 2) {
  const SensorFrame frame = stripes();
  const Segmentation result = segmenter.segment(frame);
  ASSERT_EQ(result.labels.size(), frame.colour.size());
  for (const auto& [x, label] : {std::pair(80, 0), {160, 0}, {340, person}, {560, chair}})
    for (const int y : {0, 240, 479}) EXPECT_EQ(result.labels.at<std::uint8_t>(y, x), label) << x << ' ' << y;
}

TEST(OnnxSegmenter, EveryFormOfOutput) {
  expect_stripes(*make("logits"));
  expect_stripes(*make("probabilities", {{"output", "probabilities"}}));
  expect_stripes(*make("labels", {{"output", "labels"}}));
  expect_stripes(*make("channels_last", {{"layout", "nhwc"}}));
  expect_stripes(*make("coarse"));
  expect_stripes(*make("any_size", {{"width", std::int64_t{32}}, {"height", std::int64_t{24}}}));
  expect_stripes(*make("two_outputs", {{"output_name", "shares"}, {"output", "probabilities"}}));
  expect_stripes(*make("one_channel", {{"classes", std::vector<std::string>{"background", "person"}}}), 1, 0);
}

TEST(OnnxSegmenter, OnnxruntimeReadsWhatOthersCannot) {
  if (!has_onnxruntime()) GTEST_SKIP() << "no ONNX Runtime: sh cmake/install_dependencies.sh --onnxruntime";
  const ParameterValues engine = {{"engine", "onnxruntime"}};
  expect_stripes(*make("logits", engine));
  expect_stripes(*make("half", engine));
  expect_stripes(*make("labels", {{"engine", "onnxruntime"}, {"output", "labels"}}));
  expect_stripes(*make("channels_last", {{"engine", "onnxruntime"}, {"layout", "nhwc"}}));
  expect_stripes(*make("quantised", {{"engine", "onnxruntime"}, {"scale", 1.0}}));
  expect_stripes(*make("opset_17", {{"engine", "auto"}, {"width", std::int64_t{32}}, {"height", std::int64_t{24}}}));
  EXPECT_THAT(make("logits", {{"engine", "auto"}})->description(), HasSubstr("Computed by ONNX Runtime 1."));
  EXPECT_THAT(error_of([&] { make("quantised", engine); }),
              AllOf(HasSubstr("has an input of whole numbers"), HasSubstr("expected `scale: 1`")));
}

TEST(OnnxSegmenter, ConfidenceIsTheProbabilityOfTheWinner) {
  const Segmentation result = make("logits")->segment(stripes());
  const double background = std::exp(1.0), lost = std::exp(-4.0), won = std::exp(4.0);
  EXPECT_NEAR(result.confidence.at<std::uint8_t>(200, 50), 255 * background / (background + 2 * lost), 1.0);
  EXPECT_NEAR(result.confidence.at<std::uint8_t>(200, 340), 255 * won / (won + background + lost), 1.0);
}

TEST(OnnxSegmenter, ColourOrderAndNormalisation) {
  const auto swapped = make("logits", {{"colour_order", "bgr"}});
  EXPECT_EQ(swapped->segment(frame_of(1.0, 64, 48, {255, 0, 0})).labels.at<std::uint8_t>(20, 20), 1);
  EXPECT_EQ(swapped->segment(frame_of(1.0, 64, 48, {0, 0, 255})).labels.at<std::uint8_t>(20, 20), 0);
  const auto shifted = make("logits", {{"mean", std::vector<double>{-1.0, 0.0, 0.0}}});
  EXPECT_EQ(shifted->segment(frame_of(1.0, 64, 48)).labels.at<std::uint8_t>(20, 20), 1);
}

TEST(OnnxSegmenter, NamesWhatMovesAndWhatIsUnknown) {
  const auto segmenter = make("logits", {{"classes", std::vector<std::string>{"background", "person", "unknown"}},
                                         {"movable", std::vector<std::string>{"person"}}});
  EXPECT_THAT(segmenter->movable(), ElementsAre("person"));
  expect_stripes(*segmenter, 1, 255);
}

TEST(OnnxSegmenter, WrongModelsSayWhatWasFoundAndExpected) {
  const auto error = [](const std::string& model, const ParameterValues& values = {}) {
    return error_of([&] { make(model, values); });
  };
  EXPECT_THAT(error("none"), AllOf(StartsWith(HOLDFAST_TEST_MODELS "/none.onnx: no such file"), HasSubstr("`model`")));
  EXPECT_THAT(error("logits", {{"classes", std::vector<std::string>{"background", "person"}}}),
              HasSubstr("logits.onnx: gives an output of 1x3x12x16; expected 1 x 2 (or 1) x height x width"));
  EXPECT_THAT(error("flat"), HasSubstr("gives an output of 1x576, which is no image of its input of 16x12 pixels"));
  EXPECT_THAT(error("logits", {{"width", std::int64_t{640}}}),
              HasSubstr("has an input of 1x3x12x16, but `width` is 640; expected 16"));
  EXPECT_THAT(error("any_size"), HasSubstr("has an input of 1x3x?x?, of any height; set `height`"));
  EXPECT_THAT(error("channels_last"), HasSubstr("has an input of 1x12x16x3; expected 1 x 3 x height x width"));
  EXPECT_THAT(error("two_outputs"), HasSubstr("has 2 outputs, 'scores' (1x3x12x16), 'shares' (1x3x12x16); name one"));
  EXPECT_THAT(error("two_outputs", {{"output_name", "score"}}),
              HasSubstr("has no output 'score'; did you mean 'scores'?"));
  EXPECT_THAT(error("two_inputs"), HasSubstr("has 2 inputs"));
  EXPECT_THAT(error("half"), AllOf(HasSubstr("float16 numbers, which the engine opencv cannot read"),
                                   HasSubstr("`engine: onnxruntime`")));
  EXPECT_THAT(error("opset_17", {{"width", std::int64_t{32}}, {"height", std::int64_t{24}}}),
              AllOf(HasSubstr("cannot be loaded by OpenCV"), HasSubstr("use `engine: onnxruntime`")));
  EXPECT_THAT(error("strange_layer"), AllOf(HasSubstr("strange_layer.onnx: cannot be"), HasSubstr("Sorcery")));
  EXPECT_THAT(error("logits", {{"output", "labels"}}), HasSubstr("1 x 1 x height x width"));
  EXPECT_THAT(error("one_channel",
                    {{"classes", std::vector<std::string>{"background", "person"}}, {"output", "probabilities"}}),
              HasSubstr("expected probabilities, 0 to 1; is it `output: logits`?"));
  EXPECT_THAT(error("../make_models.py"), HasSubstr("no such file"));
  EXPECT_THAT(error("logits", {{"mean", std::vector<double>{1.0}}}), HasSubstr("mean: found 1 number; expected 3"));
}

const ParameterValues two_classes = {{"classes", std::vector<std::string>{"background", "person"}}};

TEST(OnnxSegmenter, TensorsThatAreNoImageAreNamed) {
  const auto error = [](const std::string& model, ParameterValues values) {
    return error_of([&] { make(model, std::move(values)); });
  };
  ParameterValues logits = two_classes;
  logits["output"] = "logits";
  EXPECT_THAT(error("boxes", logits),
              AllOf(HasSubstr("gives an output of 1x8x72, which is no image of its input of 16x12 pixels: it looks "
                              "like the boxes of a detector, 72 with 8 numbers each"),
                    HasSubstr("expected a network for semantic segmentation, with an output of 1 x 2 (or 1) x height "
                              "x width"),
                    HasSubstr("`precomputed`")));
  EXPECT_THAT(error("boxes", two_classes),
              HasSubstr("gives 'boxes' (1x8x72), which are not the outputs of a known family for 1 class name"));
  EXPECT_THAT(error("flat", two_classes), HasSubstr("like a classifier's scores of the whole image, 576"));
  EXPECT_THAT(error("whole_image", {}), HasSubstr("like a classifier's scores of the whole image, 3"));
}

TEST(OnnxSegmenter, WhatTheLastLayerComputesIsCompared) {
  const auto error = [](const std::string& model, ParameterValues values) {
    return error_of([&] { make(model, std::move(values)); });
  };
  for (const char* model : {"labels", "cast_labels"}) {
    EXPECT_THAT(error(model, two_classes),
                AllOf(HasSubstr("labels, which its layer ArgMax has chosen"), HasSubstr("set `output: labels`")));
    ParameterValues probabilities = two_classes;
    probabilities["output"] = "probabilities";
    EXPECT_THAT(error(model, probabilities), HasSubstr("ArgMax"));
    expect_stripes(*make(model, {{"output", "labels"}}));
  }
  EXPECT_THAT(error("probabilities", {}), AllOf(HasSubstr("probabilities, because Softmax is the last layer"),
                                                HasSubstr("set `output: probabilities`")));
  EXPECT_THAT(error("sigmoid", two_classes), HasSubstr("probabilities, because Sigmoid is the last layer"));
  ParameterValues probabilities = two_classes;
  probabilities["output"] = "probabilities";
  expect_stripes(*make("sigmoid", probabilities), 1, 0);
}

TEST(OnnxSegmenter, FreeDimensionsAreThoseOfTheSettings) {
  expect_stripes(*make("resized", {{"width", std::int64_t{32}}, {"height", std::int64_t{24}}}));
  EXPECT_THAT(error_of([] { make("resized", {{"height", std::int64_t{24}}}); }), HasSubstr("set `width`"));
}

TEST(OnnxSegmenter, WrongNamesAreToldAtOnce) {
  const std::string error = error_of([] {
    make("none", {{"classes", std::vector<std::string>{"background", "person", "person"}},
                  {"movable", std::vector<std::string>{"persn"}}});
  });
  EXPECT_THAT(error, AllOf(HasSubstr("classes: 'person' stands there twice"),
                           HasSubstr("movable: 'persn' is none of the classes; did you mean 'person'?")));
}

}  // namespace
}  // namespace holdfast
