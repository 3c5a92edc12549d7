// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <memory>

#include "segmenters/segmenter_fixture.hpp"

extern "C" void holdfast_register_plugin_simulated_truth(holdfast::Registry& registry);

namespace holdfast {
namespace {

using test::error_of;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::unique_ptr<Segmenter> make(const std::vector<std::string>& classes, std::vector<std::string> known) {
  CreationContext context;
  context.class_names = std::move(known);
  return test::make_segmenter(holdfast_register_plugin_simulated_truth, "truth", {{"classes", classes}}, context);
}

SensorFrame frame_with_truth() {
  SensorFrame frame = test::frame_of(1.0, 4, 1);
  auto truth = std::make_shared<FrameTruth>();
  truth->class_labels = (cv::Mat_<std::uint8_t>(1, 4) << 0, 1, 2, 3);
  frame.truth = truth;
  return frame;
}

const std::vector<std::string> known = {"background", "chair", "person", "wall"};

TEST(TruthSegmenter, HandsOnWhatTheSourceKnows) {
  const auto segmenter = make({}, known);
  EXPECT_EQ(segmenter->classes(), known);
  const SensorFrame frame = frame_with_truth();
  Segmentation result = segmenter->segment(frame);
  EXPECT_EQ(cv::norm(result.labels, frame.truth->class_labels, cv::NORM_INF), 0.0);
  result.labels.setTo(9);
  EXPECT_EQ(frame.truth->class_labels.at<std::uint8_t>(0, 3), 3);  // the truth is not shared out
}

TEST(TruthSegmenter, FindsOnlyTheClassesAskedFor) {
  const auto segmenter = make({"wall", "chair"}, known);
  EXPECT_THAT(segmenter->classes(), ElementsAre("background", "chair", "wall"));
  const cv::Mat labels = segmenter->segment(frame_with_truth()).labels;
  EXPECT_THAT(std::vector<int>(labels.begin<std::uint8_t>(), labels.end<std::uint8_t>()), ElementsAre(0, 1, 0, 2));
}

TEST(TruthSegmenter, SeparatesObjectsIfAsked) {
  CreationContext context;
  context.class_names = known;
  const auto segmenter =
      test::make_segmenter(holdfast_register_plugin_simulated_truth, "truth",
                           {{"classes", std::vector<std::string>{"person"}}, {"instances", true}}, context);
  SensorFrame frame = test::frame_of(1.0, 5, 1);
  auto truth = std::make_shared<FrameTruth>();
  truth->class_labels = (cv::Mat_<std::uint8_t>(1, 5) << 2, 2, 0, 2, 1);
  frame.truth = truth;
  EXPECT_THAT(error_of([&] { segmenter->segment(frame); }), HasSubstr("comes without the true objects of its pixels"));
  truth->object_mask = (cv::Mat_<std::uint8_t>(1, 5) << 9, 9, 0, 4, 5);
  const Segmentation result = segmenter->segment(frame);
  ASSERT_EQ(result.found.size(), 2U) << "the chair is not asked for";
  EXPECT_EQ(result.found[1].box, cv::Rect2f(0, 0, 2, 1));
  EXPECT_THAT(std::vector<int>(result.instances.begin<std::uint16_t>(), result.instances.end<std::uint16_t>()),
              ElementsAre(2, 2, 0, 1, 0));
  EXPECT_TRUE(make({}, known)->segment(frame).instances.empty());
}

TEST(TruthSegmenter, KnowsPeopleWhereThereAreNone) {
  const auto segmenter = make({}, {"background", "chair"});
  EXPECT_THAT(segmenter->classes(), ElementsAre("background", "chair", "person"));
  const cv::Mat labels = segmenter->segment(frame_with_truth()).labels;
  EXPECT_EQ(labels.at<std::uint8_t>(0, 1), 1);
  EXPECT_THAT(make({"person"}, {"background"})->classes(), ElementsAre("background", "person"));
  EXPECT_THAT(make({"chair"}, {"background", "chair"})->classes(), ElementsAre("background", "chair"));
}

TEST(TruthSegmenter, SaysWhatToChooseInstead) {
  EXPECT_THAT(error_of([] { make({}, {}); }), HasSubstr("choose a segmenter that needs no truth: 'precomputed'"));
  EXPECT_THAT(error_of([] { make({"persn"}, known); }),
              HasSubstr("the source has no class 'persn'; did you mean 'person'?"));
  const auto segmenter = make({}, known);
  EXPECT_THAT(error_of([&] { segmenter->segment(test::frame_of(1.0, 4, 1)); }),
              AllOf(HasSubstr("frame 0 comes without the true classes"), HasSubstr("'onnx'")));
}

}  // namespace
}  // namespace holdfast
