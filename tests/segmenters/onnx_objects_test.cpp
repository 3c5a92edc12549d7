// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <opencv2/core.hpp>

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

std::unique_ptr<Segmenter> make(const std::string& model, ParameterValues values = {}) {
  values["model"] = std::string(HOLDFAST_TEST_MODELS) + "/" + model + ".onnx";
  values.try_emplace("engine", "opencv");
  return test::make_segmenter(holdfast_register_plugin_onnx, "onnx", values);
}

std::string error(const std::string& model, ParameterValues values = {}) {
  return error_of([&] { make(model, std::move(values)); });
}

const cv::Scalar red(0, 0, 255), green(0, 255, 0);

/// The boxes of the networks in a letterbox of 640x640 around frames of 640x480, which has 80 rows above it.
const cv::Rect person_box(80, 80, 240, 320), chair_box(380, 60, 200, 200);

/// Red and green things, each in part outside its box.
SensorFrame red_and_green() {
  SensorFrame frame = frame_of(1.0, 640, 480);
  frame.colour(cv::Rect(40, 120, 160, 200)).setTo(red);
  frame.colour(cv::Rect(400, 100, 80, 300)).setTo(green);
  return frame;
}

cv::Mat label_image(const std::vector<std::pair<cv::Rect, int>>& parts) {
  cv::Mat labels = cv::Mat::zeros(480, 640, CV_8UC1);
  for (const auto& [part, label] : parts) labels(part).setTo(label);
  return labels;
}

/// Number of pixels that differ. The prototypes have a quarter of the resolution, so that corners of masks are rounded.
int differences(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference;
  cv::compare(a, b, difference, cv::CMP_NE);
  return cv::countNonZero(difference);
}

constexpr int chair = 57;  // the label: 56 in COCO

TEST(OnnxObjects, InstancesOfAYoloExportNeedNothingButTheFile) {
  const auto segmenter = make("yolov8n-seg");
  ASSERT_EQ(segmenter->classes().size(), 81U);
  EXPECT_EQ(segmenter->classes()[1], "person");
  EXPECT_EQ(segmenter->classes()[chair], "chair");
  EXPECT_THAT(segmenter->movable(), ElementsAre("person"));
  EXPECT_THAT(
      segmenter->description(),
      AllOf(HasSubstr("yolov8n-seg.onnx is a network of the family yolo"), HasSubstr("instances with masks"),
            HasSubstr("Input 640x640 with a letterbox, rgb from 0 to 1."),
            HasSubstr("80 classes (person, bicycle, car, motorcycle, airplane, ...) named by its metadata"),
            HasSubstr("movable: person"), HasSubstr("Scores of at least 0.25, duplicates overlap by more than 0.7")));
  const Segmentation result = segmenter->segment(red_and_green());
  ASSERT_EQ(result.found.size(), 2U) << "duplicates are suppressed";
  const cv::Mat expected = label_image({{cv::Rect(80, 120, 120, 200), 1}, {cv::Rect(400, 100, 80, 160), chair}});
  EXPECT_LE(differences(result.labels, expected), 4) << "one pixel of a corner";
  for (std::uint16_t k = 1; k <= 2; ++k) {
    const Instance& instance = result.found[k - 1U];
    EXPECT_FLOAT_EQ(instance.score, 1.0F);
    const cv::Rect box = instance.label == 1 ? person_box : chair_box;
    EXPECT_NEAR(instance.box.x, box.x, 1e-3);
    EXPECT_NEAR(instance.box.y, box.y, 1e-3);
    EXPECT_NEAR(instance.box.width, box.width, 1e-3);
    EXPECT_NEAR(instance.box.height, box.height, 1e-3);
    EXPECT_EQ(differences(result.instances == k, result.labels == instance.label), 0);
  }
  const Segmentation nobody = segmenter->segment(frame_of(2.0, 640, 480));
  EXPECT_TRUE(nobody.found.empty());
  EXPECT_EQ(cv::countNonZero(nobody.labels), 0);
  EXPECT_FALSE(nobody.empty());
}

TEST(OnnxObjects, FreeDimensionsAreThoseOfTheMetadata) {
  const auto segmenter = make("yolov8n-seg-dynamic");
  EXPECT_THAT(segmenter->description(), HasSubstr("Input 160x96"));
  SensorFrame frame = frame_of(1.0, 320, 192);
  frame.colour(cv::Rect(80, 80, 40, 40)).setTo(red);
  const Segmentation result = segmenter->segment(frame);
  ASSERT_EQ(result.found.size(), 1U);
  EXPECT_EQ(result.found[0].box, cv::Rect2f(40, 36, 160, 120));
  cv::Mat expected = cv::Mat::zeros(192, 320, CV_8UC1);
  expected(cv::Rect(80, 80, 40, 40)).setTo(1);
  EXPECT_LE(differences(result.labels, expected), 24) << "six pixels of a corner";
  EXPECT_THAT(make("yolov8n-seg-dynamic", {{"width", std::int64_t{320}}, {"height", std::int64_t{320}}})->description(),
              HasSubstr("Input 320x320"));
}

TEST(OnnxObjects, OnnxruntimeFindsTheSame) {
  if (!has_onnxruntime()) GTEST_SKIP() << "no ONNX Runtime: sh cmake/install_dependencies.sh --onnxruntime";
  for (const char* model : {"yolov8n-seg", "yolov8n-seg-dynamic", "yolo26n-seg"}) {
    const Segmentation expected = make(model)->segment(red_and_green());
    const Segmentation found = make(model, {{"engine", "onnxruntime"}})->segment(red_and_green());
    EXPECT_EQ(found.found.size(), expected.found.size()) << model;
    EXPECT_EQ(differences(found.labels, expected.labels), 0) << model;
    EXPECT_EQ(differences(found.instances, expected.instances), 0) << model;
  }
}

/// Of frames of 320 x 240, 10 pixels for one of the inputs of 32 x 24: a red and a green thing.
SensorFrame small_red_and_green() {
  SensorFrame frame = frame_of(1.0, 320, 240);
  frame.colour(cv::Rect(40, 40, 80, 120)).setTo(red);
  frame.colour(cv::Rect(200, 80, 80, 80)).setTo(green);
  return frame;
}

TEST(OnnxObjects, MaskRcnnGivesAsManyObjectsAsThereAre) {
  if (!has_onnxruntime()) GTEST_SKIP() << "no ONNX Runtime: sh cmake/install_dependencies.sh --onnxruntime";
  std::vector<std::string> names;
  for (int i = 1; i <= 90; ++i) names.push_back(i == 1 ? "person" : i == 62 ? "chair" : "other " + std::to_string(i));
  const auto segmenter =
      make("mask_rcnn",
           {{"engine", "onnxruntime"}, {"width", std::int64_t{32}}, {"height", std::int64_t{24}}, {"classes", names}});
  EXPECT_THAT(segmenter->description(), AllOf(HasSubstr("of the family mask_rcnn"), HasSubstr("instances with masks")));
  const Segmentation result = segmenter->segment(small_red_and_green());
  ASSERT_EQ(result.found.size(), 2U);
  EXPECT_EQ(result.found[0].label, 62);
  EXPECT_FLOAT_EQ(result.found[0].score, 0.875F);
  EXPECT_EQ(result.found[1].label, 1);
  EXPECT_EQ(result.found[1].box, cv::Rect2f(20, 20, 140, 200));
  cv::Mat expected = cv::Mat::zeros(240, 320, CV_8UC1);
  expected(cv::Rect(40, 40, 80, 120)).setTo(1), expected(cv::Rect(200, 80, 80, 80)).setTo(62);
  EXPECT_LE(differences(result.labels, expected), 80) << "ten pixels of each corner";
  EXPECT_TRUE(segmenter->segment(frame_of(2.0, 320, 240)).found.empty());
  EXPECT_EQ(segmenter->segment(frame_of(2.0, 320, 240, red)).found.size(), 1U);
}

TEST(OnnxObjects, QueriesWithMasks) {
  const auto segmenter = make("maskformer", {{"classes", std::vector<std::string>{"person", "chair"}},
                                             {"mean", std::vector<double>{0, 0, 0}},
                                             {"standard_deviation", std::vector<double>{1, 1, 1}}});
  EXPECT_THAT(segmenter->description(), HasSubstr("of the family maskformer"));
  const Segmentation result = segmenter->segment(small_red_and_green());
  ASSERT_EQ(result.found.size(), 2U) << "one query finds nothing, one says that there is nothing";
  EXPECT_EQ(result.found[0].label, 1);
  EXPECT_EQ(result.found[1].label, 2);
  EXPECT_EQ(result.found[1].box, cv::Rect2f(200, 80, 80, 80));
  cv::Mat expected = cv::Mat::zeros(240, 320, CV_8UC1);
  expected(cv::Rect(40, 40, 80, 120)).setTo(1), expected(cv::Rect(200, 80, 80, 80)).setTo(2);
  EXPECT_LE(differences(result.labels, expected), 8 * 160) << "corners: a pixel of the masks is one of 40 x 40";
}

TEST(OnnxObjects, BoxesAreCutOutByDepth) {
  const auto segmenter = make("yolov8n");
  EXPECT_THAT(segmenter->description(), HasSubstr("boxes, which become masks by depth"));
  SensorFrame frame = red_and_green();
  const cv::Mat whole = label_image({{person_box, 1}, {chair_box, chair}});
  EXPECT_EQ(differences(segmenter->segment(frame).labels, whole), 0) << "without depth";
  frame.depth = cv::Mat(480, 640, CV_32FC1, cv::Scalar(3.0));
  frame.depth(cv::Rect(120, 100, 150, 340)).setTo(1.5);
  const Segmentation result = segmenter->segment(frame);
  EXPECT_EQ(differences(result.labels, label_image({{cv::Rect(120, 100, 150, 300), 1}, {chair_box, chair}})), 0);
  EXPECT_EQ(result.found.size(), 2U);
  EXPECT_EQ(differences(make("yolov8n-seg", {{"output", "boxes"}})->segment(red_and_green()).labels, whole), 0)
      << "boxes of a network with masks";
}

TEST(OnnxObjects, ObjectnessOfYolov5) {
  const auto segmenter = make("yolov5s");
  EXPECT_THAT(segmenter->description(), HasSubstr("family yolov5"));
  const Segmentation result = segmenter->segment(red_and_green());
  ASSERT_EQ(result.found.size(), 2U);
  EXPECT_FLOAT_EQ(result.found[0].score, 1.0F);
  EXPECT_EQ(result.found[1].label, chair);
  EXPECT_FLOAT_EQ(result.found[1].score, 0.5F);
  EXPECT_EQ(make("yolov5s", {{"min_score", 0.6}})->segment(red_and_green()).found.size(), 1U);
  EXPECT_EQ(differences(result.labels, label_image({{person_box, 1}, {chair_box, chair}})), 0);
}

TEST(OnnxObjects, EndToEndExportsNeedNoSuppression) {
  const auto segmenter = make("yolo26n-seg");
  EXPECT_THAT(segmenter->description(), AllOf(HasSubstr("yolo_end_to_end"), HasSubstr("no suppression")));
  SensorFrame frame = frame_of(1.0, 640, 480);
  frame.colour(cv::Rect(128, 112, 64, 64)).setTo(red);  // one cell
  const Segmentation result = segmenter->segment(frame);
  ASSERT_EQ(result.found.size(), 1U);
  EXPECT_EQ(result.found[0].label, 1);
  EXPECT_LE(differences(result.labels, label_image({{cv::Rect(128, 112, 64, 64), 1}})), 4);
}

TEST(OnnxObjects, OthersStretchTheImageAndHaveNoNames) {
  const cv::Rect box(80, 120, 240, 240);
  std::vector<std::string> detr(91, ""), coco(80, ""), voc(20, "");
  for (auto* names : {&detr, &coco, &voc})
    for (std::size_t i = 0; i < names->size(); ++i) (*names)[i] = "class " + std::to_string(i);
  detr[1] = coco[0] = voc[14] = "person";
  for (const auto& [model, names, label] : {std::tuple("detr", detr, 2), {"rtdetr", coco, 1}, {"ssd", voc, 15}}) {
    const auto segmenter = make(model, {{"classes", names}});
    EXPECT_THAT(segmenter->description(), AllOf(HasSubstr(std::string("family ") + model), HasSubstr("stretched")));
    const Segmentation result = segmenter->segment(red_and_green());
    ASSERT_FALSE(result.found.empty()) << model;
    EXPECT_EQ(result.found[0].label, label) << model;
    EXPECT_GT(result.found[0].score, 0.9F) << model;
    EXPECT_EQ(differences(result.labels, label_image({{box, label}})), 0) << model;
    EXPECT_TRUE(segmenter->segment(frame_of(1.0, 640, 480)).found.empty()) << model;
    EXPECT_THAT(error(model), HasSubstr("has no class names in its metadata (`names`); name its " +
                                        std::to_string(names.size()) + " classes in `classes`"));
  }
  EXPECT_THAT(make("detr", {{"classes", detr}})->description(), HasSubstr("rgb from (-2.118 -2.036 -1.804) to (2.249"));
  EXPECT_THAT(make("detr", {{"classes", detr}, {"colour_order", "bgr"}})->description(),
              HasSubstr("bgr from (-1.804 -2.036 -2.118) to"));
}

TEST(OnnxObjects, ClassesOfTheSettings) {
  std::vector<std::string> names(80, "");
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = "thing " + std::to_string(i);
  const auto segmenter = make("yolov8n", {{"classes", names}, {"movable", std::vector<std::string>{"thing 56"}}});
  EXPECT_THAT(segmenter->movable(), ElementsAre("thing 56"));
  EXPECT_EQ(segmenter->classes()[chair], "thing 56");
  names.insert(names.begin(), "background");
  EXPECT_EQ(make("yolov8n", {{"classes", names}})->classes()[chair], "thing 56");
  EXPECT_THAT(make("yolov8n", {{"classes", names}})->description(), HasSubstr("movable: not said"));
}

TEST(OnnxObjects, WrongParametersAreNamed) {
  using Names = std::vector<std::string>;
  EXPECT_THAT(
      error("yolov8n", {{"classes", Names{"background", "person"}}}),
      AllOf(HasSubstr("segmenter.onnx.classes: found 2 names, but the metadata of yolov8n.onnx names 80 classes "
                      "(person, bicycle, car, motorcycle, airplane, ...); expected a name for each"),
            HasSubstr("`movable`")));
  EXPECT_THAT(error("yolov8n", {{"family", "yolov5"}}), HasSubstr("not the outputs of the `family` yolov5"));
  EXPECT_THAT(error("yolov8n", {{"movable", Names{"persn"}}}),
              HasSubstr("movable: 'persn' is none of the classes; did you mean 'person'?"));
  EXPECT_THAT(error("yolov8n", {{"output", "instances"}}),
              AllOf(HasSubstr("without masks; expected prototypes"), HasSubstr("set `output: boxes`")));
  EXPECT_THAT(error("yolov8n", {{"output", "logits"}}), HasSubstr("which is no image of its input of 640x640 pixels"));
  EXPECT_THAT(error("yolov8n", {{"output", "boxes"}, {"output_name", "output0"}}),
              HasSubstr("output_name: has no effect, because all outputs"));
  EXPECT_THAT(error("yolov8n", {{"width", std::int64_t{320}}}), HasSubstr("`width` is 320; expected 640"));
  EXPECT_THAT(error("yolov8n", {{"mean", std::vector<double>{0.5}}}), HasSubstr("mean: found 1 number; expected 3"));
  EXPECT_THAT(error("yolov8n-seg", {{"mean", std::vector<double>{-2.0, 0.0, 0.0}}}),
              AllOf(HasSubstr("gives a score of 2.0"), HasSubstr("`mean`")));
  const Names three = {"background", "person", "chair"};
  EXPECT_THAT(error("logits", {{"classes", three}, {"min_score", 0.5}, {"fit", "letterbox"}}),
              AllOf(HasSubstr("segmenter.onnx.fit: has no effect, because the network is run as a semantic one"),
                    HasSubstr("segmenter.onnx.min_score: has no effect")));
  EXPECT_THAT(error("logits", {{"classes", three}, {"output", "boxes"}}),
              HasSubstr("not the outputs of a known family"));
}

/// A folder with a network and a preset beside it.
struct NetworkWithPreset {
  explicit NetworkWithPreset(const std::string& model, const std::string& preset) {
    std::string name = (std::filesystem::temp_directory_path() / "holdfast_preset_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) ADD_FAILURE() << "no folder";
    folder = name;
    std::filesystem::copy(std::string(HOLDFAST_TEST_MODELS) + "/" + model + ".onnx", folder / "net.onnx");
    std::ofstream(folder / "mine.yaml") << preset;
  }
  ~NetworkWithPreset() { std::filesystem::remove_all(folder); }
  std::unique_ptr<Segmenter> make(ParameterValues values = {}) const {
    values["model"] = (folder / "net.onnx").string();
    values["engine"] = "opencv";
    values.try_emplace("preset", "mine.yaml");
    return test::make_segmenter(holdfast_register_plugin_onnx, "onnx", values);
  }
  std::filesystem::path folder;
};

TEST(OnnxPresets, AFileGivesWhatTheConfigurationLeavesOut) {
  const NetworkWithPreset network("yolov5s", "# mine\nmin_score: 0.6\ncolour_order: rgb\n");
  EXPECT_EQ(network.make()->segment(red_and_green()).found.size(), 1U);
  EXPECT_EQ(network.make({{"min_score", 0.3}})->segment(red_and_green()).found.size(), 2U);
  const NetworkWithPreset other("yolov5s", "colour_order: bgr\nfit: stretch");
  EXPECT_THAT(other.make()->description(), AllOf(HasSubstr("stretched, bgr from 0 to 1"),
                                                 HasSubstr("at least 0.25, duplicates overlap by more than 0.45")));
  EXPECT_THAT(other.make({{"fit", "letterbox"}, {"colour_order", "rgb"}})->description(),
              HasSubstr("with a letterbox, rgb from 0 to 1"));
}

TEST(OnnxPresets, ThoseOfTheModuleHoldForTheirFamilyOrByName) {
  EXPECT_THAT(make("yolov8n", {{"preset", "yolo"}})->description(), HasSubstr("with a letterbox, rgb from 0 to 1"));
  EXPECT_THAT(error("yolov8n", {{"preset", "fastestdet"}}), HasSubstr("not the outputs of the `family` fastestdet"));
  EXPECT_THAT(make("one_channel", {{"preset", "sinet"}})->description(), HasSubstr("bgr from (-0.006411"));
  EXPECT_THAT(error("one_channel", {{"preset", "prisma"}}),
              HasSubstr("there is no preset 'prisma'; did you mean 'prisma_net'?"));
}

TEST(OnnxPresets, WrongValuesAreNamed) {
  const auto error_with = [](const std::string& preset) {
    return error_of([&] { NetworkWithPreset("yolov5s", preset).make(); });
  };
  EXPECT_THAT(error_with("fit: stretch\nmin_scor: 1"),
              AllOf(HasSubstr("mine.yaml:2:1"), HasSubstr("did you mean 'min_score'?")));
  EXPECT_THAT(error_with("min_score: much"), HasSubstr("min_score is not what it must be; expected a number"));
  EXPECT_THAT(error_with("min_score: 7"), HasSubstr("from 0 to 1"));
  EXPECT_THAT(error_with("fit: squeeze"), HasSubstr("expected"));
  EXPECT_THAT(error_with("model: other.onnx"), HasSubstr("'model' is no parameter of a preset"));
  EXPECT_THAT(error_with("[1, 2]"), HasSubstr("is no map"));
  EXPECT_THAT(error_with("a: ["), HasSubstr("expected YAML"));
  const NetworkWithPreset network("yolov5s", "");
  EXPECT_THAT(error_of([&] { network.make({{"preset", "none.yaml"}}); }), HasSubstr("none.yaml"));
}

TEST(OnnxObjects, SemanticNetworksAreAsBefore) {
  const auto segmenter = make("one_channel");
  EXPECT_THAT(segmenter->classes(), ElementsAre("background", "person"));
  EXPECT_THAT(segmenter->movable(), ElementsAre());
  EXPECT_THAT(
      segmenter->description(),
      HasSubstr(
          "one_channel.onnx is a semantic network, output logits. Input 16x12, stretched, rgb from 0 to 1. 2 classes"));
  const Segmentation result = segmenter->segment(frame_of(1.0, 64, 48, {0, 0, 200}));
  EXPECT_EQ(result.labels.at<std::uint8_t>(20, 20), 1);
  EXPECT_TRUE(result.instances.empty());
}

}  // namespace
}  // namespace holdfast
