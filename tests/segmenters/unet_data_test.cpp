// SPDX-License-Identifier: BSD-3-Clause
// The shipped weights on photographs that they were not trained on: plugins/segmenters/unet/training/validation.txt.
#include <algorithm>
#include <fstream>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "holdfast/evaluation/segmentation_evaluation.hpp"
#include "holdfast/inference/network.hpp"
#include "segmenters/segmenter_fixture.hpp"

extern "C" void holdfast_register_plugin_unet(holdfast::Registry& registry);

namespace holdfast {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t person = 1;

std::vector<std::string> held_out_photographs() {
  std::ifstream list(HOLDFAST_TRAINING "/validation.txt");
  const std::string source = "voc_person/";
  std::vector<std::string> names;
  for (std::string line; std::getline(list, line);)
    if (line.starts_with(source)) names.push_back(line.substr(source.size()));
  return names;
}

/// Of PASCAL VOC's class indices: 15 = person, 255 = unlabelled border.
cv::Mat people_of(const cv::Mat& voc_labels) {
  cv::Mat labels = cv::Mat::zeros(voc_labels.size(), CV_8UC1);
  labels.setTo(person, voc_labels == 15);
  labels.setTo(255, voc_labels == 255);
  return labels;
}

TEST(UnetData, FindsPeopleInPhotographsThatItNeverSaw) {
  const char* data = std::getenv("HOLDFAST_DATA");
  if (data == nullptr) GTEST_SKIP() << "HOLDFAST_DATA is not set";
  const fs::path folder = fs::path(data) / "people" / "voc_person";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is missing";
  const std::vector<std::string> names = held_out_photographs();
  ASSERT_GT(names.size(), 100U);
  const auto segmenter = test::make_segmenter(holdfast_register_plugin_unet, "unet", {});
  SegmentationEvaluator evaluator({"background", "person"}, "");
  for (std::size_t i = 0; i < names.size(); i += 4) {
    SensorFrame frame = test::frame_of(0.0, 16, 16);
    frame.colour = cv::imread((folder / "images" / (names[i] + ".jpg")).string());
    const cv::Mat labels = cv::imread((folder / "labels" / (names[i] + ".png")).string(), cv::IMREAD_UNCHANGED);
    ASSERT_FALSE(frame.colour.empty() || labels.empty()) << names[i];
    const cv::Mat found = segmenter->segment(frame).labels == person;
    evaluator.add(people_of(labels), found & person);
  }
  // docs: plugins/segmenters/unet/README.md says how well it does on all of them.
  EXPECT_GT(evaluator.result().classes[person].iou(), 0.72);
}

/// Of all pixels of some photographs with people and half as many frames of a room, the share whose labels differ from
/// OpenCV's.
double share_of_other_labels(const fs::path& data, const std::string& engine, std::size_t photographs,
                             const std::string& precision = "fp32") {
  std::vector<fs::path> files;
  const std::vector<std::string> names = held_out_photographs();
  for (std::size_t i = 0; i < photographs; ++i)
    files.push_back(data / "people" / "voc_person" / "images" / (names[i] + ".jpg"));
  std::vector<fs::path> room;
  for (const auto& entry : fs::directory_iterator(data / "tum_fr1_xyz" / "rgb")) room.push_back(entry.path());
  std::sort(room.begin(), room.end());
  for (std::size_t i = 0; i < photographs / 2; ++i) files.push_back(room[i * room.size() / (photographs / 2)]);
  const auto opencv = test::make_segmenter(holdfast_register_plugin_unet, "unet", {{"engine", std::string("opencv")}});
  const auto other =
      test::make_segmenter(holdfast_register_plugin_unet, "unet", {{"engine", engine}, {"precision", precision}});
  double pixels = 0.0, others = 0.0;
  for (const fs::path& file : files) {
    SensorFrame frame = test::frame_of(0.0, 16, 16);
    frame.colour = cv::imread(file.string());
    EXPECT_FALSE(frame.colour.empty()) << file;
    const cv::Mat differs = opencv->segment(frame).labels != other->segment(frame).labels;
    pixels += static_cast<double>(differs.total());
    others += cv::countNonZero(differs);
  }
  return others / pixels;
}

/// The folder of recordings, empty without those of this test.
fs::path data_of_engines() {
  const char* data = std::getenv("HOLDFAST_DATA");
  if (data == nullptr) return {};
  for (const char* folder : {"people/voc_person", "tum_fr1_xyz/rgb"})
    if (!fs::exists(fs::path(data) / folder)) return {};
  return data;
}

TEST(UnetData, OnnxruntimeGivesTheSameLabels) {
  const fs::path data = data_of_engines();
  if (data.empty()) GTEST_SKIP() << "HOLDFAST_DATA has no people/voc_person or tum_fr1_xyz";
  if (!has_onnxruntime()) GTEST_SKIP() << "no ONNX Runtime: sh cmake/install_dependencies.sh --onnxruntime";
  const double share = share_of_other_labels(data, "onnxruntime", 10);
  std::cout << "onnxruntime: other labels " << share << '\n';
  EXPECT_LE(share, 0.001);
}

#if defined(HOLDFAST_ONEDNN)
TEST(UnetData, BothEnginesGiveTheSameLabels) {
  const fs::path data = data_of_engines();
  if (data.empty()) GTEST_SKIP() << "HOLDFAST_DATA has no people/voc_person or tum_fr1_xyz";
  const double full = share_of_other_labels(data, "onednn", 40);
  std::cout << "fp32: other labels " << full << '\n';
  EXPECT_LE(full, 0.0001);
  try {
    const double half = share_of_other_labels(data, "onednn", 40, "bf16");
    std::cout << "bf16: other labels " << half << '\n';
    EXPECT_LE(half, 0.01);
  } catch (const ConfigurationError& error) {
    EXPECT_NE(std::string(error.what()).find("AVX512_BF16"), std::string::npos) << error.what();
  }
}
#endif

}  // namespace
}  // namespace holdfast
