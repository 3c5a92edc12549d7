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

TEST(OnnxData, FastestDetFindsWhatItsAuthorsShow) {
  const char* recordings = std::getenv("HOLDFAST_RECORDINGS");
  const fs::path folder = fs::path(recordings == nullptr ? "" : recordings) / "FastestDet/example/onnx-runtime";
  if (!fs::exists(folder / "FastestDet.onnx")) GTEST_SKIP() << "no FastestDet in HOLDFAST_RECORDINGS";
  for (const char* engine : {"opencv", "onnxruntime"}) {
    if (std::string(engine) == "onnxruntime" && !has_onnxruntime()) continue;
    const auto segmenter = test::make_segmenter(holdfast_register_plugin_onnx, "onnx",
                                                {{"model", (folder / "FastestDet.onnx").string()},
                                                 {"family", "fastestdet"},
                                                 {"colour_order", "bgr"},
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
