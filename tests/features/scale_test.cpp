// SPDX-License-Identifier: BSD-3-Clause
// The octave of a feature says how large it is: in an image of half the size, the same feature lies an octave lower.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "features/test_images.hpp"
#include "holdfast/core/descriptor_distance.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/plugin/registry.hpp"

extern "C" void holdfast_register_plugin_akaze(holdfast::Registry&);
extern "C" void holdfast_register_plugin_sift(holdfast::Registry&);

namespace holdfast {
namespace {

class ScaleSpaces : public testing::TestWithParam<const char*> {};

TEST_P(ScaleSpaces, AFeatureOfHalfTheSizeIsAnOctaveLower) {
  Registry registry;
  holdfast_register_plugin_akaze(registry);
  holdfast_register_plugin_sift(registry);
  const auto extractor = registry.create<FeatureExtractor>(GetParam(), {}, CreationContext{});
  cv::Mat image = test::scene_image(640, 480, 11), half;
  cv::GaussianBlur(image, image, {0, 0}, 2.0);
  cv::resize(image, half, {}, 0.5, 0.5, cv::INTER_AREA);
  Features large, small;
  extractor->extract(image, {}, large);
  extractor->extract(half, {}, small);
  ASSERT_GT(large.size(), 50U);

  const DescriptorView of_large = large.descriptors, of_small = small.descriptors;
  const DescriptorDistances distances(extractor->descriptor_type());
  const double levels_of_octave = std::log(2.0) / extractor->pyramid().log_factor;
  std::vector<double> steps;  // levels by which a feature lies lower
  for (std::size_t i = 0; i < large.size(); ++i)
    for (std::size_t k = 0; k < small.size(); ++k) {
      const float dx = large.x[i] / 2.0F - small.x[k], dy = large.y[i] / 2.0F - small.y[k];
      if (std::hypot(dx, dy) > 1.5F || large.octave[i] + 1 == extractor->pyramid().levels()) continue;
      if (distances.of_two(of_large.row(i), of_small.row(k)) > extractor->descriptor_type().strict_distance) continue;
      steps.push_back(static_cast<double>(large.octave[i]) - static_cast<double>(small.octave[k]));
    }
  ASSERT_GT(steps.size(), 20U) << "features of both images";
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  EXPECT_NEAR(steps[steps.size() / 2], levels_of_octave, 1.0);
}

INSTANTIATE_TEST_SUITE_P(Plugins, ScaleSpaces, testing::Values("akaze", "sift"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace holdfast
