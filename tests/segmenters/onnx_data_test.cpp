// SPDX-License-Identifier: BSD-3-Clause
// Real networks of others, which are not in the repository: HOLDFAST_RECORDINGS names the folder of those that are
// here.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>

#include "holdfast/inference/network.hpp"
#include "segmenters/segmenter_fixture.hpp"

extern "C" void holdfast_register_plugin_onnx(holdfast::Registry& registry);

namespace holdfast {
namespace {

namespace fs = std::filesystem;

/// Lines of a file.
std::vector<std::string> names_of(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> names;
  for (std::string line; std::getline(stream, line);)
    if (!line.empty()) names.push_back(line);
  return names;
}

/// A network of a folder of HOLDFAST_RECORDINGS; empty if it is not there.
fs::path recording(const std::string& name) {
  const char* recordings = std::getenv("HOLDFAST_RECORDINGS");
  const fs::path file = fs::path(recordings == nullptr ? "" : recordings) / name;
  return fs::exists(file) ? file : fs::path();
}

/// Networks for portraits of github.com/anilsathyan7/Portrait-Segmentation (MIT), on a photograph beside them.
TEST(OnnxData, PortraitNetworksFindTheManInAPhotograph) {
  struct Portrait {
    const char* model;
    ParameterValues values;
  };
  const std::vector<Portrait> networks = {
      {"SINet/SINet.onnx", {{"preset", "sinet"}}},
      {"SINet/SINet_Softmax.onnx", {{"preset", "sinet"}, {"output", "probabilities"}}},
      {"models/deeplab_dm05_513/deeplab_nchw.onnx", {}},
      {"models/prisma_seg/prisma_nchw.onnx", {{"preset", "prisma_net"}}}};
  if (!has_onnxruntime()) GTEST_SKIP() << "no ONNX Runtime: install_dependencies.sh --onnxruntime brings it";
  SensorFrame frame = test::frame_of(0.0, 16, 16);
  const fs::path photograph = recording("Portrait-Segmentation/SINet/obama.jpg");
  if (photograph.empty()) GTEST_SKIP() << "no Portrait-Segmentation in HOLDFAST_RECORDINGS";
  frame.colour = cv::imread(photograph.string());
  ASSERT_EQ(frame.colour.size(), cv::Size(1314, 1752));
  // Head, shirt and shoulders, and the wall and the flag behind him, by eye.
  const cv::Rect him[] = {{330, 300, 630, 900}, {450, 1400, 400, 350}, {90, 1500, 300, 250}};
  const cv::Rect behind[] = {{0, 0, 1314, 90}, {1100, 0, 214, 1100}, {0, 0, 180, 1100}};
  for (const Portrait& network : networks) {
    ParameterValues values = network.values;
    values["model"] = recording(std::string("Portrait-Segmentation/") + network.model).string();
    values["engine"] = "onnxruntime";
    const auto segmenter = test::make_segmenter(holdfast_register_plugin_onnx, "onnx", values);
    const Segmentation result = segmenter->segment(frame);
    const auto share = [&](const cv::Rect& part) { return cv::mean(result.labels(part) == 1)[0] / 255.0; };
    for (const cv::Rect& part : him) EXPECT_GT(share(part), 0.95) << network.model << ' ' << part;
    for (const cv::Rect& part : behind) EXPECT_LT(share(part), 0.03) << network.model << ' ' << part;
    EXPECT_NEAR(cv::mean(result.labels)[0], 0.57, 0.1) << network.model;
  }
}

TEST(OnnxData, FastestDetFindsWhatItsAuthorsShow) {
  const fs::path folder = recording("FastestDet/example/onnx-runtime");
  if (folder.empty()) GTEST_SKIP() << "no FastestDet in HOLDFAST_RECORDINGS";
  for (const char* engine : {"opencv", "onnxruntime"}) {
    if (std::string(engine) == "onnxruntime" && !has_onnxruntime()) continue;
    const auto segmenter = test::make_segmenter(holdfast_register_plugin_onnx, "onnx",
                                                {{"model", (folder / "FastestDet.onnx").string()},
                                                 {"preset", "fastestdet"},
                                                 {"min_score", 0.65},
                                                 {"engine", engine},
                                                 {"classes", names_of(folder / "coco.names")}});
    SensorFrame frame = test::frame_of(0.0, 16, 16);
    frame.colour = cv::imread((folder / "3.jpg").string());
    ASSERT_FALSE(frame.colour.empty());
    const Segmentation result = segmenter->segment(frame);
    // As the picture result.jpg beside the network shows them.
    ASSERT_EQ(result.found.size(), 4U) << engine;
    const double scores[] = {0.9, 0.9, 0.8, 0.78};
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(segmenter->classes()[result.found[i].label], "person");
      EXPECT_NEAR(result.found[i].score, scores[i], 0.02) << engine << ' ' << i;
    }
    for (const cv::Rect2f& shown : {cv::Rect2f(40, 62, 138, 231), cv::Rect2f(288, 141, 195, 157)})
      EXPECT_TRUE(std::any_of(result.found.begin(), result.found.end(), [&](const Instance& instance) {
        return (instance.box & shown).area() > 0.9F * (instance.box | shown).area();
      })) << shown;
  }
}

}  // namespace
}  // namespace holdfast
