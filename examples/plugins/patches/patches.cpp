// SPDX-License-Identifier: BSD-3-Clause
#include <opencv2/imgproc.hpp>

#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/plugin/plugin.hpp"
using namespace holdfast;
struct Patches final : FeatureExtractor {
  Patches(const NoSettings&, const CreationContext&) {}
  const ScalePyramid& pyramid() const override { return one_level; }
  bool has_angles() const override { return false; }
  DescriptorType descriptor_type() const override {
    return {DescriptorKind::float32, DescriptorMetric::cosine, 64, /*strict=*/0.1F, /*loose=*/0.25F};
  }
  void extract(const cv::Mat& image, const cv::Mat& ignore, Features& out) override {
    out.resize(0, descriptor_type());
    if (image.cols < 24 || image.rows < 24) return;
    const cv::Mat grey = image.clone();  // filters of OpenCV read beyond a piece of a larger image
    std::vector<cv::Point2f> corners;
    cv::goodFeaturesToTrack(grey, corners, 1000, 0.002, 7, ignore.empty() ? cv::noArray() : cv::Mat(ignore == 0));
    for (const cv::Point2f& corner : corners) {
      const cv::Rect patch(static_cast<int>(corner.x) - 8, static_cast<int>(corner.y) - 8, 17, 17);
      if ((patch & cv::Rect(cv::Point(), grey.size())) != patch) continue;
      const std::size_t i = out.size();
      out.resize(i + 1);
      out.x[i] = corner.x, out.y[i] = corner.y;
      cv::Mat small, descriptor(8, 8, CV_32FC1, out.descriptors.numbers(i).data());
      cv::resize(grey(patch), small, descriptor.size(), 0, 0, cv::INTER_AREA);
      small.convertTo(descriptor, CV_32F);
      descriptor -= cv::mean(descriptor)[0];
      const double length = cv::norm(descriptor);
      descriptor /= std::max(length, 1.0);
      out.resize(length > 1.0 ? i + 1 : i);  // without texture there is no direction
    }
  }
  ScalePyramid one_level{1, 2.0};
};

HOLDFAST_PLUGIN(patches, registry) {
  registry.add<FeatureExtractor, Patches, NoSettings>({.name = "patches", .summary = "Corners with 8x8 grey values."});
}
