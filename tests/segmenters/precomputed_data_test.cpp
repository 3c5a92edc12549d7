// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>

#include "segmenters/segmenter_fixture.hpp"

extern "C" void holdfast_register_plugin_precomputed(holdfast::Registry& registry);

namespace holdfast {
namespace {

TEST(PrecomputedData, PseudoLabelsOfTumAreFoundNearEveryFrame) {
  const char* data = std::getenv("HOLDFAST_DATA");
  if (data == nullptr) GTEST_SKIP() << "HOLDFAST_DATA is not set";
  const auto folder = std::filesystem::path(data) / "tum_fr1_xyz" / "labels_pseudo";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is missing";
  const auto segmenter = test::make_segmenter(
      holdfast_register_plugin_precomputed, "precomputed",
      {{"path", folder.string()}, {"tolerance", 0.2}, {"labels", TextMap{{"15", "person"}, {"255", "unknown"}}}});
  int people = 0;
  for (const double stamp : {1305031102.175304, 1305031102.25, 1305031110.0, 1305031120.0}) {
    const Segmentation result = segmenter->segment(test::frame_of(stamp, 640, 480));
    ASSERT_FALSE(result.empty()) << stamp;
    const cv::Mat person = result.labels == 1, unknown = result.labels == 255, background = result.labels == 0;
    EXPECT_EQ(cv::countNonZero(person) + cv::countNonZero(unknown) + cv::countNonZero(background), 640 * 480);
    people += cv::countNonZero(person);
  }
  EXPECT_GT(people, 1000);
  EXPECT_TRUE(segmenter->segment(test::frame_of(1305031000.0, 640, 480)).empty());
}

}  // namespace
}  // namespace holdfast
