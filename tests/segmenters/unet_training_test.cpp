// SPDX-License-Identifier: BSD-3-Clause
// The training of the U-Net, from simulated frames to labels in C++; needs Python with PyTorch, NumPy and OpenCV.
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>

#include "segmenters/segmenter_fixture.hpp"

extern "C" void holdfast_register_plugin_unet(holdfast::Registry& registry);

namespace holdfast {
namespace {

namespace fs = std::filesystem;

int run(const std::string& command) { return std::system(command.c_str()); }

/// The first Python that has all it takes; Debian's packages belong to /usr/bin/python3, whatever comes first in PATH.
std::string find_python() {
  for (const std::string python : {"python3", "/usr/bin/python3"})
    if (run(python + " -c 'import cv2, numpy, torch' 2>/dev/null") == 0) return python;
  return "";
}

TEST(UnetTraining, LossFallsAndCppFindsWhatPytorchFinds) {
  const std::string python = find_python();
  if (python.empty()) GTEST_SKIP() << "python3 lacks torch, numpy or cv2: sh cmake/install_dependencies.sh --training";
  std::string name = (fs::temp_directory_path() / "holdfast_unet_XXXXXX").string();
  const fs::path folder = mkdtemp(name.data());
  const std::string log = (folder / "log.txt").string();
  const auto quoted = [](const fs::path& path) { return "'" + path.string() + "'"; };
  ASSERT_EQ(run(quoted(HOLDFAST_PROGRAM) + " simulate " + quoted(HOLDFAST_SCENES "/crowd.yaml") +
                " --frame-rate 0.5 --duration 12 --quiet --output " + quoted(folder / "crowd") + " >" + log + " 2>&1"),
            0)
      << std::ifstream(log).rdbuf();
  ASSERT_EQ(run(python + " " + quoted(HOLDFAST_TRAINING "/smoke.py") + " " + quoted(folder / "crowd") + " --output " +
                quoted(folder / "out") + " >" + log + " 2>&1"),
            0)
      << std::ifstream(log).rdbuf();

  SensorFrame frame;
  frame.colour = cv::imread((folder / "out/picture.png").string());
  const cv::Mat expected = cv::imread((folder / "out/labels.png").string(), cv::IMREAD_GRAYSCALE);
  ASSERT_FALSE(frame.colour.empty() || expected.empty());
  const auto segmenter = test::make_segmenter(holdfast_register_plugin_unet, "unet",
                                              {{"model", (folder / "out/unet.onnx").string()},
                                               {"width", std::int64_t{64}},
                                               {"height", std::int64_t{48}},
                                               {"mirror", false}});
  const cv::Mat found = segmenter->segment(frame).labels, same = found == expected;
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_GE(cv::countNonZero(same), 0.999 * static_cast<double>(same.total()));
  EXPECT_GT(cv::countNonZero(expected), 0) << "a network that finds nothing compares nothing";
  fs::remove_all(folder);
}

}  // namespace
}  // namespace holdfast
