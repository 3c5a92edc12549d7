// SPDX-License-Identifier: BSD-3-Clause
// What the interface promises, of the extractors of the program, made through the registry as a configuration makes
// them.
#include <gtest/gtest.h>

#include <numbers>

#include "features/test_images.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/plugin/registry.hpp"

extern "C" void holdfast_register_plugin_akaze(holdfast::Registry&);
extern "C" void holdfast_register_plugin_orb(holdfast::Registry&);
extern "C" void holdfast_register_plugin_opencv_orb(holdfast::Registry&);
extern "C" void holdfast_register_plugin_sift(holdfast::Registry&);

namespace holdfast {
namespace {

class Extractors : public testing::TestWithParam<const char*> {
 protected:
  Extractors() {
    holdfast_register_plugin_orb(registry_);
    holdfast_register_plugin_opencv_orb(registry_);
    holdfast_register_plugin_akaze(registry_);
    holdfast_register_plugin_sift(registry_);
  }
  std::unique_ptr<FeatureExtractor> make(const ParameterValues& values = {}) {
    return registry_.create<FeatureExtractor>(GetParam(), values, CreationContext{});
  }
  Features extract(const cv::Mat& image, const cv::Mat& ignore = {}, const ParameterValues& values = {}) {
    Features features;
    make(values)->extract(image, ignore, features);
    return features;
  }
  Registry registry_;
};

TEST_P(Extractors, FillEveryArrayWithinItsRange) {
  const Features features = extract(test::scene_image(320, 240, 1), {}, {{"count", std::int64_t{300}}});
  EXPECT_GT(features.size(), 200U);
  EXPECT_LE(features.size(), 330U);  // OpenCV keeps ties
  for (const std::size_t size : {features.y.size(), features.angle.size(), features.response.size(),
                                 features.octave.size(), features.descriptors.size()})
    EXPECT_EQ(size, features.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    EXPECT_TRUE(features.x[i] >= 0 && features.x[i] <= 319 && features.y[i] >= 0 && features.y[i] <= 239);
    EXPECT_TRUE(features.angle[i] >= 0 && features.angle[i] < 2 * std::numbers::pi_v<float>);
    EXPECT_LT(features.octave[i], make()->pyramid().levels());
  }
}

TEST_P(Extractors, HonourTheIgnoreMask) {
  const cv::Mat image = test::scene_image(320, 240, 2);
  cv::Mat ignore(image.size(), CV_8UC1, cv::Scalar(0));
  ignore(cv::Rect(0, 0, 160, 240)) = 1;
  const Features features = extract(image, ignore);
  EXPECT_GT(features.size(), 100U);
  for (std::size_t i = 0; i < features.size(); ++i) EXPECT_GT(features.x[i], 155.0F);  // coarse levels are coarse
}

TEST_P(Extractors, FindNothingInEmptyTinyAndFlatImages) {
  EXPECT_TRUE(extract(cv::Mat()).empty());
  std::vector<cv::Size> sizes = {{1, 1}, {7, 300}, {31, 31}, {400, 20}};
  if (make()->descriptor_type() == DescriptorType()) sizes.emplace_back(38, 38);  // ORB keeps away from borders
  for (const cv::Size& size : sizes)
    EXPECT_TRUE(extract(test::noise_image(size.width, size.height, 3)).empty()) << size;
  EXPECT_TRUE(extract(cv::Mat(200, 200, CV_8UC1, cv::Scalar(77))).empty());
}

TEST_P(Extractors, TakeImagesOfAnySizeOneAfterAnother) {
  const auto extractor = make();
  const cv::Mat image = test::scene_image(317, 203, 4);
  Features first, other, again;
  extractor->extract(image, {}, first);
  for (const cv::Size size : {cv::Size(70, 64), cv::Size(641, 99), cv::Size(99, 401)})
    extractor->extract(test::scene_image(size.width, size.height, 5), {}, other);
  extractor->extract(image, {}, again);
  EXPECT_GT(first.size(), 100U);
  EXPECT_EQ(first.x, again.x);
  EXPECT_EQ(first.y, again.y);
  EXPECT_EQ(first.angle, again.angle);
  EXPECT_EQ(first.descriptors, again.descriptors);
}

TEST_P(Extractors, PyramidFollowsTheParameters) {
  if (make()->descriptor_type() != DescriptorType()) GTEST_SKIP() << "a scale space has parameters of its own";
  const auto extractor = make({{"levels", std::int64_t{3}}, {"scale_factor", 1.5}});
  EXPECT_EQ(extractor->pyramid().levels(), 3);
  EXPECT_FLOAT_EQ(extractor->pyramid().scale[2], 2.25F);
  Features features;
  extractor->extract(test::scene_image(320, 240, 6), {}, features);
  EXPECT_EQ(*std::max_element(features.octave.begin(), features.octave.end()), 2);
}

INSTANTIATE_TEST_SUITE_P(Plugins, Extractors, testing::Values("orb", "opencv_orb", "akaze", "sift"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace holdfast
