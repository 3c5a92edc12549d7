// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "holdfast/inference/network.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"
#include "segmenters/segmenter_fixture.hpp"

extern "C" void holdfast_register_plugin_unet(holdfast::Registry& registry);

namespace holdfast {
namespace {

using test::error_of;
using testing::ElementsAre;
using testing::HasSubstr;

std::unique_ptr<Segmenter> make(const ParameterValues& values = {}) {
  return test::make_segmenter(holdfast_register_plugin_unet, "unet", values);
}

/// Pixels of people that a segmenter and the truth agree on, and each alone.
struct Agreement {
  int both = 0, found = 0, real = 0;
  double iou() const { return both / static_cast<double>(found + real - both); }
};

/// Where the truth shows people: 255, elsewhere 0.
cv::Mat real_people(const SensorFrame& frame, const std::vector<std::string>& names) {
  const auto person = std::find(names.begin(), names.end(), "person") - names.begin();
  return frame.truth->class_labels == person;
}

Agreement compare(Segmenter& segmenter, const SensorFrame& frame, const cv::Mat& real) {
  const cv::Mat found = segmenter.segment(frame).labels == 1;
  return {cv::countNonZero(found & real), cv::countNonZero(found), cv::countNonZero(real)};
}

Agreement compare(Segmenter& segmenter, simulation::Simulator& simulator, std::uint64_t index) {
  const SensorFrame frame = simulator.frame(index);
  return compare(segmenter, frame, real_people(frame, simulator.class_names()));
}

simulation::Simulator room_with(const std::string& people) {
  return {
      simulation::read_scene("", {"duration=0.2", "frame_rate=10", "camera.path=static", "people=[" + people + "]"}),
      find_camera("tum_fr1").value()};
}

class Unet : public testing::TestWithParam<std::string> {};

TEST_P(Unet, FindsAPersonInARoomAndNobodyInAnEmptyOne) {
  const auto segmenter = make({{"size", GetParam()}});
  simulation::Simulator with_person = room_with("{ at: [2.5, 3.0] }"), empty = room_with("");
  EXPECT_GT(compare(*segmenter, with_person, 0).iou(), 0.6);
  EXPECT_LT(compare(*segmenter, empty, 0).found, 640 * 480 / 100);
}

TEST_P(Unet, SameImageSameLabels) {
  simulation::Simulator room = room_with("{ at: [2.5, 3.0] }");
  const SensorFrame frame = room.frame(0);
  const auto first = make({{"size", GetParam()}}), second = make({{"size", GetParam()}});
  const Segmentation once = first->segment(frame), other = second->segment(frame), again = first->segment(frame);
  EXPECT_EQ(once.labels.size(), frame.colour.size());
  EXPECT_EQ(once.confidence.size(), frame.colour.size());
  for (const Segmentation* result : {&other, &again}) {
    EXPECT_EQ(cv::norm(once.labels, result->labels, cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(once.confidence, result->confidence, cv::NORM_INF), 0.0);
  }
}

TEST(UnetSegmenter, RegionsOfPeopleNeedACertainPixel) {
  simulation::Simulator room = room_with("{ at: [2.5, 3.0] }");
  SensorFrame frame = room.frame(0);
  // Less and less contrast, until people are found of whom the network is not certain.
  int largest = 255;
  for (double contrast = 0.7; contrast > 0.05 && largest == 255; contrast *= 0.7) {
    frame.colour = room.frame(0).colour.clone();
    frame.colour.convertTo(frame.colour, -1, contrast, 128.0 * (1.0 - contrast));
    const Segmentation all = make()->segment(frame);
    const cv::Mat people = all.labels == 1;
    double highest = 255.0;
    if (cv::countNonZero(people) > 0) cv::minMaxLoc(all.confidence, nullptr, &highest, nullptr, nullptr, people);
    largest = static_cast<int>(highest);
  }
  ASSERT_LT(largest, 255);
  const auto people_with = [&](int certainty) {
    return cv::countNonZero(make({{"region_confidence", certainty / 255.0}})->segment(frame).labels == 1);
  };
  EXPECT_GT(people_with(largest), 0);
  EXPECT_EQ(people_with(largest + 1), 0);
}

TEST(UnetSegmenter, WithItsMirrorImageLeftAndRightAreAlike) {
  simulation::Simulator room = room_with("{ at: [2.5, 3.0] }");
  const SensorFrame frame = room.frame(0);
  SensorFrame mirrored;
  cv::flip(frame.colour, mirrored.colour, 1);
  // Within what rounding may decide, the labels of the mirror image are the mirror image of the labels.
  const auto difference = [&](bool mirror) {
    const auto segmenter = make({{"mirror", mirror}});
    cv::Mat labels = segmenter->segment(frame).labels, other;
    cv::flip(segmenter->segment(mirrored).labels, other, 1);
    const cv::Mat differs = labels != other;
    return cv::countNonZero(differs);
  };
  EXPECT_LT(difference(true), 640 * 480 / 10000);
  EXPECT_GT(difference(false), 640 * 480 / 1000);
}

TEST(UnetSegmenter, ASecondLookFindsMoreOfPeopleWhoAreFarAway) {
  // The view of a person fills a quarter of the image of an empty room: there the person has half the size.
  simulation::Simulator room = room_with("{ at: [2.5, 3.5] }");
  const SensorFrame near = room.frame(0);
  const cv::Rect part(100, 300, 640, 480);
  SensorFrame frame = room_with("").frame(0);
  cv::resize(frame.colour, frame.colour, cv::Size(), 2.0, 2.0, cv::INTER_LINEAR);
  near.colour.copyTo(frame.colour(part));
  cv::Mat real = cv::Mat::zeros(frame.colour.size(), CV_8UC1);
  real_people(near, room.class_names()).copyTo(real(part));
  const auto once = make({{"size", "small"}}), twice = make({{"size", "small"}, {"second_look", true}});
  EXPECT_GT(compare(*twice, frame, real).iou(), compare(*once, frame, real).iou() + 0.1);
  // An image that the first look shows in full has no second one.
  SensorFrame small = room.frame(0);
  cv::resize(small.colour, small.colour, cv::Size(224, 192), 0, 0, cv::INTER_AREA);
  EXPECT_EQ(cv::norm(once->segment(small).labels, twice->segment(small).labels, cv::NORM_INF), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Sizes, Unet, testing::Values("small", "base", "large"));

#if defined(HOLDFAST_ONEDNN)
TEST(UnetSegmenter, BothEnginesGiveTheSameLabels) {
  simulation::Simulator room = room_with("{ at: [2.5, 3.0] }");
  const SensorFrame frame = room.frame(0);
  for (const char* size : {"small", "base", "large"}) {
    const cv::Mat expected = make({{"size", std::string(size)}})->segment(frame).labels;
    const auto differing = [&](const char* precision) {
      const auto segmenter =
          make({{"size", std::string(size)}, {"engine", std::string("onednn")}, {"precision", std::string(precision)}});
      const cv::Mat differs = segmenter->segment(frame).labels != expected;
      return static_cast<double>(cv::countNonZero(differs)) / static_cast<double>(expected.total());
    };
    EXPECT_LE(differing("fp32"), 0.0001) << size;
    try {
      EXPECT_LE(differing("bf16"), 0.01) << size;
    } catch (const ConfigurationError& error) {
      EXPECT_THAT(error.what(), HasSubstr("AVX512_BF16"));
    }
  }
}
#endif

TEST(UnetSegmenter, OnnxruntimeGivesTheSameLabels) {
  if (!has_onnxruntime()) GTEST_SKIP() << "no ONNX Runtime: sh cmake/install_dependencies.sh --onnxruntime";
  simulation::Simulator room = room_with("{ at: [2.5, 3.0] }");
  const SensorFrame frame = room.frame(0);
  const cv::Mat expected = make({{"engine", std::string("opencv")}})->segment(frame).labels;
  const cv::Mat differs = make({{"engine", std::string("onnxruntime")}})->segment(frame).labels != expected;
  EXPECT_LE(cv::countNonZero(differs), 0.001 * static_cast<double>(expected.total()));
  EXPECT_GT(cv::countNonZero(expected), 1000);
}

TEST(UnetSegmenter, SaysWhatItKnowsAndWhatMoves) {
  const auto segmenter = make();
  EXPECT_THAT(segmenter->classes(), ElementsAre("background", "person", "chair", "table", "tv"));
  EXPECT_THAT(segmenter->movable(), ElementsAre("person"));
}

TEST(UnetSegmenter, OnlyTheBuiltInWeightsAreLoadedInTheBackground) {
  EXPECT_TRUE(make()->first_call_waits());
  EXPECT_TRUE(make({{"size", std::string("small")}})->first_call_waits());
  EXPECT_FALSE(make({{"width", 64}, {"height", 64}})->first_call_waits());
  for (const char* engine : {"opencv", "auto"})
    for (const char* size : {"small", "base", "large"})
      make({{"engine", std::string(engine)}, {"size", std::string(size)}})->finish_loading();
}

TEST(UnetSegmenter, AWrongSideSaysWhichOnesFit) {
  EXPECT_THAT(error_of([] {
                make({{"width", 200}});
              }),
              HasSubstr("segmenter.unet.width is 200; expected a multiple of 32, such as 192 or 224"));
  EXPECT_THAT(error_of([] { make({{"height", 20}}); }), HasSubstr("expected a multiple of 32, such as 32"));
}

TEST(UnetSegmenter, WrongWeightsSayWhatWasExpected) {
  EXPECT_THAT(error_of([] { make({{"model", std::string("absent.onnx")}}); }), HasSubstr("absent.onnx: no such file"));
  EXPECT_THAT(error_of([] {
                make({{"model", std::string(HOLDFAST_TEST_MODELS "/any_size.onnx")}});
              }),
              HasSubstr("expected 1 x 5 x height x width"));
}

}  // namespace
}  // namespace holdfast
