// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "holdfast/core/error.hpp"
#include "holdfast/inference/model_metadata.hpp"
#include "holdfast/inference/object_layout.hpp"
#include "holdfast/inference/object_masks.hpp"
#include "holdfast/inference/object_output.hpp"

namespace holdfast {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

template <class Run>
std::string message_of(Run&& run) {
  try {
    run();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ModelMetadata, ClassNamesOfPythonAndJson) {
  const auto names = [](const std::string& text) { return read_class_names(text).value(); };
  EXPECT_THAT(names("{0: 'person', 1: 'bicycle'}"), ElementsAre("person", "bicycle"));
  EXPECT_THAT(names(R"({"1": "bicycle", "0": "per\"son",})"), ElementsAre("per\"son", "bicycle"));
  EXPECT_THAT(names(R"({0: "traffic's light", 2: 'it\'s'})"), ElementsAre("traffic's light", "class 1", "it's"));
  EXPECT_THAT(names("[ 'a', 'b' ,'a']"), ElementsAre("a", "b", "a 2"));
  EXPECT_THAT(names("{}"), ElementsAre());
  for (const char* text : {"", "person", "{0: 'person'", "{0 'person'}", "{'x': 'person'}", "{99999: 'a'}", "['a' 'b']",
                           "{-1: 'a'}", "['a'] b", "{0: 'a}", "{0: 'a\\"})
    EXPECT_FALSE(read_class_names(text)) << text;
}

TEST(ModelMetadata, TaskAndSizeOfTheInput) {
  const ModelMetadata square = read_model_metadata({{"task", "segment"}, {"imgsz", "[480, 640]"}, {"names", "?"}});
  EXPECT_EQ(square.task, "segment");
  EXPECT_EQ(square.height, 480);
  EXPECT_EQ(square.width, 640);
  EXPECT_TRUE(square.names.empty());
  EXPECT_EQ(read_model_metadata({{"imgsz", "320"}}).width, 320);
  EXPECT_EQ(read_model_metadata({{"imgsz", "[9999999999999999999, 640]"}}).width, 0);
  EXPECT_EQ(read_model_metadata({{"imgsz", "[]"}}).height, 0);
}

ObjectQuestion question(const std::vector<std::vector<std::int64_t>>& shapes, int classes = 80,
                        cv::Size input = {640, 640}) {
  ObjectQuestion result{.outputs = {}, .input = input, .task = "", .classes = classes, .model = "net.onnx"};
  for (const auto& shape : shapes)
    result.outputs.push_back(
        {.name = "output" + std::to_string(result.outputs.size()), .element_type = 1, .shape = shape});
  return result;
}

TEST(ObjectLayout, SignaturesOfRealExportsAreRecognised) {
  const ObjectLayout seg = recognise_objects(question({{1, 116, 8400}, {1, 32, 160, 160}}));
  EXPECT_EQ(seg.preset.family, ObjectFamily::yolo);
  EXPECT_TRUE(seg.is_transposed);
  EXPECT_EQ(seg.count, 8400);
  EXPECT_EQ(seg.width, 116);
  EXPECT_EQ(seg.classes, 80);
  EXPECT_EQ(seg.coefficients, 32);
  EXPECT_EQ(seg.prototypes, 1U);
  const auto family = [](const ObjectQuestion& asked) { return recognise_objects(asked).preset.family; };
  EXPECT_EQ(family(question({{1, 84, 8400}})), ObjectFamily::yolo);
  EXPECT_EQ(family(question({{1, 84, 8400}}, 0)), ObjectFamily::yolo);
  EXPECT_EQ(family(question({{1, 5, 8400}}, 1)), ObjectFamily::yolo);
  EXPECT_EQ(family(question({{1, 84, 6300}}, 80, {640, 480})), ObjectFamily::yolo);
  EXPECT_EQ(family(question({{1, 8400, 84}})), ObjectFamily::yolo);
  EXPECT_EQ(family(question({{1, 25200, 85}})), ObjectFamily::yolov5);
  EXPECT_EQ(family(question({{1, 25200, 85}}, 0)), ObjectFamily::yolov5);
  const ObjectLayout v5 = recognise_objects(question({{1, 25200, 117}, {1, 32, 160, 160}}));
  EXPECT_EQ(v5.preset.family, ObjectFamily::yolov5);
  EXPECT_FALSE(v5.is_transposed);
  EXPECT_EQ(v5.classes, 80);
  EXPECT_EQ(family(question({{1, 300, 38}, {1, 32, 160, 160}})), ObjectFamily::yolo_end_to_end);
  EXPECT_EQ(family(question({{1, 300, 6}}, 2)), ObjectFamily::yolo_end_to_end);
  EXPECT_EQ(family(question({{1, 300, 84}})), ObjectFamily::rtdetr);
  EXPECT_EQ(family(question({{1, 300, 80}, {1, 300, 4}})), ObjectFamily::rtdetr);
  EXPECT_EQ(family(question({{1, 100, 92}, {1, 100, 4}}, 91)), ObjectFamily::detr);
  EXPECT_EQ(family(question({{1, 100, 92}, {1, 100, 4}}, 0)), ObjectFamily::detr);
}

TEST(ObjectLayout, ListsOfScoresAreOfTheFamilyOfTheirLastLayer) {
  ObjectQuestion shares = question({{1, 3000, 21}, {1, 3000, 4}}, 20, {300, 300});
  shares.outputs[0].computed_by = "Softmax";
  const ObjectLayout ssd = recognise_objects(shares);
  EXPECT_EQ(ssd.preset.family, ObjectFamily::ssd);
  EXPECT_EQ(ssd.boxes, 1U);
  EXPECT_EQ(ssd.scores, 0U);
  EXPECT_EQ(ssd.classes, 20);
  ObjectQuestion numbered = question({{200, 4}, {200}, {200}}, 90, {320, 320});
  numbered.outputs[1].name = "scores";
  numbered.outputs[2].name = "Labels";
  const ObjectLayout chosen = recognise_objects(numbered);
  EXPECT_EQ(chosen.preset.scores, ScoreForm::numbered);
  EXPECT_EQ(chosen.scores, 1U);
  EXPECT_EQ(chosen.numbers, 2U);
}

TEST(ObjectLayout, OthersAreRefusedWithWhatTheyAre) {
  EXPECT_THAT(
      message_of([] {
        recognise_objects(question({{1, 84, 8400}}, 3));
      }),
      AllOf(HasSubstr("net.onnx: gives 'output0' (1x84x8400), which are not the outputs of a known family for 3 "
                      "class names"),
            HasSubstr("correct `classes`, name the `family`")));
  ObjectQuestion asked = question({{1, 84, 8400}});
  asked.family = ObjectFamily::yolov5;
  EXPECT_THAT(message_of([&] { recognise_objects(asked); }), HasSubstr("not the outputs of the `family` yolov5"));
  asked.family = ObjectFamily::yolo;
  EXPECT_EQ(recognise_objects(asked).classes, 80);
  asked.task = "pose";
  EXPECT_THAT(message_of([&] { recognise_objects(asked); }), HasSubstr("a network for the task 'pose'"));
  // Boxes that are still relative to their cells (YOLOX) must not be taken for pixels.
  EXPECT_THAT(message_of([] { recognise_objects(question({{1, 8400, 85}})); }), HasSubstr("known family"));
  EXPECT_THAT(message_of([] { recognise_objects(question({{1, 8400, 85}}, 0)); }), HasSubstr("known family"));
  EXPECT_THAT(message_of([] { recognise_objects(question({{1, 3, 48, 64}})); }), HasSubstr("known family"));
  EXPECT_THAT(message_of([] { recognise_objects(question({{1, 8, 72}}, 0)); }), HasSubstr("known family"));
  EXPECT_THAT(message_of([] { recognise_objects(question({})); }), HasSubstr("known family"));
}

TEST(ObjectLayout, DeclarationsTellObjectsFromImages) {
  const auto is_list = [](std::vector<std::int64_t> input, std::vector<std::vector<std::int64_t>> shapes,
                          const std::string& task = "") {
    OnnxSignature signature;
    signature.inputs = {{.name = "image", .element_type = 1, .shape = std::move(input)}};
    for (const auto& shape : shapes) signature.outputs.push_back({.name = "o", .element_type = 1, .shape = shape});
    ModelMetadata metadata;
    metadata.task = task;
    return declares_objects(signature, metadata);
  };
  EXPECT_TRUE(is_list({1, 3, 640, 640}, {{1, 84, 8400}}));
  EXPECT_TRUE(is_list({1, 3, 640, 640}, {{1, 300, 6}}));
  EXPECT_TRUE(is_list({-1, 3, -1, -1}, {{-1, 100, 92}, {-1, 100, 4}}));
  EXPECT_TRUE(is_list({-1, 3, -1, -1}, {{-1, 116, -1}, {-1, 32, -1, -1}}, "segment"));
  EXPECT_FALSE(is_list({1, 3, 513, 513}, {{1, 513, 513}})) << "labels without a dimension of channels";
  EXPECT_FALSE(is_list({1, 3, 480, 640}, {{1, 21, 480, 640}}));
  EXPECT_FALSE(is_list({1, 3, -1, -1}, {{1, 2, -1, -1}}));
  EXPECT_FALSE(is_list({1, 3, 224, 224}, {{1, 1000}}));
  EXPECT_FALSE(is_list({1, 3, 224, 224}, {{}}));
}

/// A network of three classes with four boxes; each box has four numbers, and scores.
cv::Mat list_of(int boxes, int numbers, const std::vector<float>& values) {
  const int sizes[] = {1, boxes, numbers};
  cv::Mat result(3, sizes, CV_32FC1);
  std::copy(values.begin(), values.end(), result.ptr<float>());
  return result;
}

ObjectLayout layout_of(BoxForm box, BoxUnit unit, ScoreForm scores, int count, int width, int classes) {
  ObjectLayout layout{{ObjectFamily::yolo, "a test", box, unit, scores, 0.0F}};
  layout.count = count, layout.width = width, layout.classes = classes;
  return layout;
}

void expect_box(const cv::Rect2f& box, float x, float y, float width, float height) {
  EXPECT_NEAR(box.x, x, 1e-3);
  EXPECT_NEAR(box.y, y, 1e-3);
  EXPECT_NEAR(box.width, width, 1e-3);
  EXPECT_NEAR(box.height, height, 1e-3);
}

TEST(ObjectOutput, BoxesAroundTheirCentreInBothOrders) {
  const std::vector<float> rows = {50, 40, 20, 10, 0.1F, 0.9F,  //
                                   30, 30, 10, 10, 0.2F, 0.2F,  // too low
                                   5,  95, 30, 30, 0.5F, 0.3F};
  const cv::Mat list = list_of(3, 6, rows);
  cv::Mat turned = list_of(6, 3, rows);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 6; ++j) turned.ptr<float>()[j * 3 + i] = rows[static_cast<std::size_t>(i * 6 + j)];
  ObjectLayout layout = layout_of(BoxForm::centre, BoxUnit::pixels, ScoreForm::probabilities, 3, 6, 2);
  for (const bool is_transposed : {false, true}) {
    layout.is_transposed = is_transposed;
    const auto found = decode_objects({is_transposed ? turned : list}, layout, {100, 100}, 0.25, 2, "net");
    ASSERT_EQ(found.size(), 2U);
    EXPECT_EQ(found[0].class_number, 1);
    EXPECT_FLOAT_EQ(found[0].score, 0.9F);
    expect_box(found[0].box, 40, 35, 20, 10);
    EXPECT_EQ(found[1].class_number, 0);
    expect_box(found[1].box, 0, 80, 20, 20);  // clipped to the input
  }
}

TEST(ObjectOutput, CellsOfFastestDet) {
  ObjectQuestion question{.outputs = {{.name = "758", .shape = {1, 7, 2, 4}}},
                          .input = {64, 32},
                          .classes = 2,
                          .family = ObjectFamily::fastestdet,
                          .model = "net"};
  const ObjectLayout layout = recognise_objects(question);
  EXPECT_EQ(layout.count, 8);
  const int shape[] = {1, 7, 2, 4};
  cv::Mat output = cv::Mat::zeros(4, shape, CV_32F);
  const auto set = [&](int channel, float value) {
    output.ptr<float>()[8 * channel + 4 + 2] = value;
  };  // row 1, column 2
  set(0, 0.5F), set(1, 0.0F), set(2, std::atanh(-0.5F)), set(6, 0.25F);
  set(3, std::log(0.25F / 0.75F)), set(4, 0.0F);  // a quarter wide, half high
  const auto found = decode_objects({output}, layout, question.input, 0.1, 2, "net");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].class_number, 1);
  EXPECT_NEAR(found[0].score, std::pow(0.5, 0.6) * std::pow(0.25, 0.4), 1e-6);
  expect_box(found[0].box, 32 - 8, 8 - 8, 16, 16);
  question.classes = 3;
  EXPECT_THROW(recognise_objects(question), InputError);
  question.classes = 2, question.family = ObjectFamily::automatic;
  EXPECT_THROW(recognise_objects(question), InputError) << "a semantic network has such an output, too";
}

TEST(ObjectOutput, EveryFormOfScores) {
  const auto first = [](const std::vector<cv::Mat>& outputs, const ObjectLayout& layout) {
    const auto found = decode_objects(outputs, layout, {100, 200}, 0.1, 3, "net");
    EXPECT_EQ(found.size(), 1U);
    return found.empty() ? Detection{} : found.front();
  };
  const Detection objectness = first({list_of(1, 8, {50, 50, 20, 20, 0.5F, 0.1F, 0.8F, 0.3F})},
                                     layout_of(BoxForm::centre, BoxUnit::pixels, ScoreForm::objectness, 1, 8, 3));
  EXPECT_EQ(objectness.class_number, 1);
  EXPECT_FLOAT_EQ(objectness.score, 0.4F);
  const Detection best = first({list_of(1, 6, {10, 20, 30, 50, 0.7F, 2})},
                               layout_of(BoxForm::corners, BoxUnit::pixels, ScoreForm::best, 1, 6, 0));
  EXPECT_EQ(best.class_number, 2);
  expect_box(best.box, 10, 20, 20, 30);

  const cv::Mat boxes = list_of(1, 4, {0.5F, 0.5F, 0.2F, 0.1F});
  ObjectLayout two = layout_of(BoxForm::centre, BoxUnit::fractions, ScoreForm::logits, 1, 4, 3);
  two.scores = 1;
  const Detection logits = first({boxes, list_of(1, 3, {-3, 2, 0})}, two);
  EXPECT_EQ(logits.class_number, 1);
  EXPECT_NEAR(logits.score, 1.0 / (1.0 + std::exp(-2.0)), 1e-6);
  expect_box(logits.box, 40, 90, 20, 20);

  two.preset.scores = ScoreForm::softmax;
  const Detection softmax = first({boxes, list_of(1, 4, {0, 1, 2, 1})}, two);
  EXPECT_EQ(softmax.class_number, 2);
  EXPECT_NEAR(softmax.score, std::exp(2.0) / (1.0 + 2.0 * std::exp(1.0) + std::exp(2.0)), 1e-6);
  EXPECT_TRUE(decode_objects({boxes, list_of(1, 4, {0, 1, 2, 9})}, two, {100, 200}, 0.1, 3, "net").empty())
      << "no object";

  two.preset.scores = ScoreForm::background_first;
  two.preset.box = BoxForm::corners, two.preset.unit = BoxUnit::either;
  const Detection share =
      first({list_of(1, 4, {0.1F, 0.2F, 0.3F, 0.4F}), list_of(1, 4, {0.2F, 0.1F, 0.1F, 0.6F})}, two);
  EXPECT_EQ(share.class_number, 2);
  expect_box(share.box, 10, 40, 20, 40);
  expect_box(first({list_of(1, 4, {10, 20, 30, 40}), list_of(1, 4, {0, 0, 0, 1})}, two).box, 10, 20, 20, 20);

  two.preset.scores = ScoreForm::numbered;
  two.numbers = 2;
  const cv::Mat corners = list_of(1, 4, {0.1F, 0.2F, 0.3F, 0.4F});
  const Detection numbered = first({corners, list_of(1, 1, {0.8F}), list_of(1, 1, {3})}, two);
  EXPECT_EQ(numbered.class_number, 2);
  EXPECT_TRUE(
      decode_objects({corners, list_of(1, 1, {0.8F}), list_of(1, 1, {0})}, two, {100, 200}, 0.1, 3, "net").empty())
      << "background";
}

TEST(ObjectOutput, HostileNumbersAreErrors) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const ObjectLayout layout = layout_of(BoxForm::centre, BoxUnit::pixels, ScoreForm::best, 1, 6, 0);
  const auto error = [&](const std::vector<float>& numbers, int names = 3) {
    return message_of([&] { decode_objects({list_of(1, 6, numbers)}, layout, {100, 100}, 0.1, names, "net"); });
  };
  EXPECT_THAT(error({nan, 1, 2, 3, 0.5F, 0}), HasSubstr("net: gives numbers that are not finite"));
  EXPECT_THAT(error({1, 1, 2, infinity, 0.5F, 0}), HasSubstr("not finite"));
  EXPECT_THAT(error({1, 1, 2, 3, nan, 0}), HasSubstr("gives a score of nan; expected probabilities"));
  EXPECT_THAT(error({1, 1, 2, 3, 7, 0}), AllOf(HasSubstr("score of 7.0"), HasSubstr("correct `family`")));
  EXPECT_THAT(error({1, 1, 2, 3, 0.5F, 0.5F}), HasSubstr("the class number 0.5"));
  EXPECT_THAT(error({1, 1, 2, 3, 0.5F, nan}), HasSubstr("the class number nan"));
  EXPECT_THAT(error({1, 1, 2, 3, 0.5F, 3}), HasSubstr("an object of class 3; expected numbers below 3"));
  EXPECT_EQ(error({1e30F, -1e30F, 1e30F, 1e30F, 0.5F, 0}), "no error");
  EXPECT_THAT(message_of([&] {
                decode_objects({list_of(1, 7, std::vector<float>(7))}, layout, {9, 9}, 0.1, 3, "net");
              }),
              HasSubstr("gives an output of 7 numbers; expected 1 x 6"));
  EXPECT_THAT(message_of([&] { decode_objects({}, layout, {9, 9}, 0.1, 3, "net"); }), HasSubstr("0 numbers"));
}

TEST(ObjectOutput, SuppressionIsOfOneClass) {
  std::vector<Detection> objects = {{0, 0.9F, {0, 0, 10, 10}, {}},
                                    {1, 0.8F, {0, 0, 10, 10}, {}},
                                    {0, 0.7F, {0, 0, 10, 6}, {}},   // overlap 0.6
                                    {0, 0.6F, {0, 5, 10, 10}, {}},  // 1/3
                                    {0, 0.5F, {50, 50, 5, 5}, {}}};
  EXPECT_NEAR(overlap(objects[0].box, objects[2].box), 0.6, 1e-9);
  EXPECT_NEAR(overlap(objects[0].box, objects[3].box), 1.0 / 3.0, 1e-9);
  EXPECT_EQ(overlap({}, {}), 0.0);
  std::vector<Detection> some = objects, all = objects, few = objects, none = objects;
  suppress_duplicates(some, 0.5);
  ASSERT_EQ(some.size(), 4U);
  EXPECT_FLOAT_EQ(some[2].score, 0.6F);
  suppress_duplicates(few, 0.2);
  EXPECT_EQ(few.size(), 3U);
  suppress_duplicates(all, 1.0);
  EXPECT_EQ(all.size(), 5U);
  suppress_duplicates(none, 1.0, 2);
  EXPECT_EQ(none.size(), 2U);
}

TEST(ObjectMasks, PlaceInALetterbox) {
  const FramePlace wide = place_of_frame({640, 480}, {640, 640}, true);
  EXPECT_EQ(wide.content, cv::Rect(0, 80, 640, 480));
  expect_box(wide.box_in_frame({80, 160, 240, 320}), 80, 80, 240, 320);
  expect_box(wide.box_in_frame({0, 0, 640, 640}), 0, 0, 640, 480);
  const FramePlace half = place_of_frame({1000, 500}, {320, 320}, true);
  EXPECT_EQ(half.content, cv::Rect(0, 80, 320, 160));
  expect_box(half.box_in_frame({32, 96, 64, 32}), 100, 50, 200, 100);
  EXPECT_EQ(place_of_frame({480, 640}, {320, 320}, true).content, cv::Rect(40, 0, 240, 320));
  const FramePlace stretched = place_of_frame({640, 480}, {320, 320}, false);
  EXPECT_EQ(stretched.content, cv::Rect(0, 0, 320, 320));
  expect_box(stretched.box_in_frame({32, 32, 64, 64}), 64, 48, 128, 96);
  EXPECT_EQ(place_of_frame({10000, 1}, {32, 32}, true).content, cv::Rect(0, 15, 32, 1));
}

TEST(ObjectMasks, PixelsOfABox) {
  EXPECT_EQ(pixels_of({1.4F, 2.6F, 2.0F, 2.0F}, {10, 10}), cv::Rect(1, 3, 2, 2));
  EXPECT_EQ(pixels_of({2.6F, 2.6F, 0.1F, 0.1F}, {10, 10}), cv::Rect(3, 3, 1, 1));
  EXPECT_EQ(pixels_of({0, 0, 10, 10}, {10, 10}), cv::Rect(0, 0, 10, 10));
  EXPECT_EQ(pixels_of({9.7F, 0, 5, 5}, {10, 10}), cv::Rect(9, 0, 1, 5));
  for (const cv::Rect2f& box :
       {cv::Rect2f(10, 0, 5, 5), cv::Rect2f(-5, 0, 5, 5), cv::Rect2f(1, 1, 0, 5), cv::Rect2f(1, 1, std::nanf(""), 5)})
    EXPECT_TRUE(pixels_of(box, {10, 10}).empty()) << box;
}

/// Prototypes of an input of 64x64 at a quarter of its size: 0 is positive in the left half, 1 in the upper half.
cv::Mat halves() {
  const int sizes[] = {1, 2, 16, 16};
  cv::Mat result(4, sizes, CV_32FC1);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      result.ptr<float>()[y * 16 + x] = x < 8 ? 1.0F : -1.0F;
      result.ptr<float>()[256 + y * 16 + x] = y < 8 ? 1.0F : -1.0F;
    }
  return result;
}

TEST(ObjectMasks, PrototypesAreCombinedAndCutByTheBox) {
  const FramePlace place = place_of_frame({128, 64}, {64, 64}, true);  // scaled by half, 16 rows above it
  ASSERT_EQ(place.content, cv::Rect(0, 16, 64, 32));
  const cv::Rect pixels(20, 10, 60, 40);
  const auto mask_of = [&](const std::vector<float>& coefficients) {
    cv::Mat whole = cv::Mat::zeros(64, 128, CV_8UC1);
    prototype_mask(halves(), coefficients, place, pixels).copyTo(whole(pixels));
    return whole;
  };
  const auto expected = [](const cv::Rect& part) {
    cv::Mat whole = cv::Mat::zeros(64, 128, CV_8UC1);
    whole(part).setTo(255);
    return whole;
  };
  EXPECT_EQ(cv::norm(mask_of({1, 0}), expected({20, 10, 44, 40}), cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(mask_of({-1, 0}), expected({64, 10, 16, 40}), cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(mask_of({0, 1}), expected({20, 10, 60, 22}), cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(mask_of({0, 0}), expected({}), cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::countNonZero(mask_of({std::nanf(""), 1})), 0);
  EXPECT_TRUE(prototype_mask(halves(), std::vector<float>{1, 0}, place, {}).empty());
}

TEST(ObjectMasks, DepthSeparatesAnObjectFromWhatIsBehindAndBefore) {
  cv::Mat depth(100, 100, CV_32FC1, cv::Scalar(4.0));
  depth(cv::Rect(35, 20, 30, 70)).setTo(2.0);  // a person
  depth(cv::Rect(45, 30, 10, 5)).setTo(2.2);   // some of it is farther
  depth(cv::Rect(20, 70, 60, 20)).setTo(1.0);  // a table before it
  depth(cv::Rect(36, 22, 2, 2)).setTo(0.0);    // not measured
  const cv::Rect pixels(30, 15, 40, 80);
  cv::Mat expected = cv::Mat::zeros(100, 100, CV_8UC1);
  expected(cv::Rect(35, 20, 30, 50)).setTo(255);
  EXPECT_EQ(cv::norm(depth_mask(depth, pixels), expected(pixels), cv::NORM_INF), 0.0);
  const cv::Mat all(pixels.size(), CV_8UC1, cv::Scalar(255));
  EXPECT_EQ(cv::norm(depth_mask({}, pixels), all, cv::NORM_INF), 0.0) << "no depth";
  EXPECT_EQ(cv::norm(depth_mask(cv::Mat::zeros(100, 100, CV_32FC1), pixels), all, cv::NORM_INF), 0.0) << "not measured";
}

TEST(ObjectMasks, MovableObjectsCoverOthersThenTheHigherScore) {
  const cv::Mat full(4, 4, CV_8UC1, cv::Scalar(255));
  const auto object = [&](std::uint8_t label, float score, int x, bool is_movable) {
    return ObjectMask{
        {label, score, cv::Rect2f(static_cast<float>(x), 0, 4, 4)}, cv::Rect(x, 0, 4, 4), full, is_movable};
  };
  const Segmentation joined =
      join_objects({object(7, 0.9F, 2, false), object(1, 0.6F, 4, true), object(7, 0.5F, 0, false)}, {12, 5});
  const auto row = [](const cv::Mat& image) {
    std::vector<int> values;
    for (int x = 0; x < image.cols; ++x)
      values.push_back(image.depth() == CV_16U ? image.at<std::uint16_t>(1, x) : image.at<std::uint8_t>(1, x));
    return values;
  };
  EXPECT_THAT(row(joined.labels), ElementsAre(7, 7, 7, 7, 1, 1, 1, 1, 0, 0, 0, 0));
  EXPECT_THAT(row(joined.instances), ElementsAre(3, 3, 1, 1, 2, 2, 2, 2, 0, 0, 0, 0));
  EXPECT_THAT(row(joined.confidence), ElementsAre(191, 191, 242, 242, 204, 204, 204, 204, 255, 255, 255, 255));
  EXPECT_EQ(cv::countNonZero(joined.labels.row(4)), 0);
  ASSERT_EQ(joined.found.size(), 3U);
  EXPECT_EQ(joined.found[1].label, 1);
  const Segmentation none = join_objects({}, {12, 5});
  EXPECT_FALSE(none.empty());
  EXPECT_EQ(cv::countNonZero(none.labels), 0);
}

}  // namespace
}  // namespace holdfast
