// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/stereo_depth.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "holdfast/core/stereo_calibration.hpp"
#include "holdfast/core/thread_name.hpp"

namespace holdfast {

namespace {

/// Semi-global matching at half the resolution, with the penalties that OpenCV's documentation recommends.
cv::Ptr<cv::StereoSGBM> semi_global_matcher(double max_disparity, int width) {
  constexpr int block = 5, step = 16;  // px; the number of disparities is a multiple of the step
  const int wanted = static_cast<int>(std::ceil(std::min(max_disparity, 0.5 * width) / 2.0));
  const int disparities = std::max(step, (wanted + step - 1) / step * step);
  constexpr int uniqueness = 10, speckle_size = 60, speckle_range = 2;
  return cv::StereoSGBM::create(0, disparities, block, 8 * block * block, 32 * block * block, 1, 0, uniqueness,
                                speckle_size, speckle_range, cv::StereoSGBM::MODE_SGBM);
}

}  // namespace

StereoDepth::StereoDepth(const Camera& camera, const StereoParts& parts)
    : parts_(parts), fx_baseline_(camera.fx * camera.baseline), matcher_(parts.settings) {
  if (!parts.is_dense) return;
  dense_matcher_ = semi_global_matcher(fx_baseline_ / parts.settings.minimum_depth, camera.width);
}

const cv::Mat& StereoDepth::dense(const cv::Mat& left, const cv::Mat& right) {
  if (!dense_matcher_) return dense_;
  const cv::Size half(left.cols / 2, left.rows / 2);
  cv::resize(left, half_left_, half, 0, 0, cv::INTER_AREA);
  cv::resize(right, half_right_, half, 0, 0, cv::INTER_AREA);
  dense_matcher_->compute(half_left_, half_right_, disparity_);
  dense_.create(left.size(), CV_32FC1);
  // Disparities are sixteenths of a pixel of the half resolution.
  const float numerator = static_cast<float>(fx_baseline_ * 16.0 / 2.0);
  const int least = std::max(1, static_cast<int>(std::lround(parts_.settings.minimum_disparity * 8.0)));
  for (int row = 0; row < dense_.rows; ++row) {
    const std::int16_t* from = disparity_.ptr<std::int16_t>(std::min(row / 2, half.height - 1));
    float* to = dense_.ptr<float>(row);
    for (int column = 0; column < dense_.cols; ++column) {
      const std::int16_t value = from[std::min(column / 2, half.width - 1)];
      to[column] = value >= least ? numerator / static_cast<float>(value) : 0.0F;
    }
  }
  return dense_;
}

void StereoDepth::extract(const cv::Mat& left, const cv::Mat& right, const cv::Mat& ignore, FeatureExtractor& extractor,
                          Frame& frame) {
  if (parts_.right_features == nullptr || std::thread::hardware_concurrency() < 2) {
    extractor.extract(left, ignore, frame.features);
    (parts_.right_features != nullptr ? *parts_.right_features : extractor).extract(right, cv::Mat(), right_features_);
    return;
  }
  std::future<void> other = std::async(std::launch::async, [&] {
    name_this_thread("right features");
    parts_.right_features->extract(right, cv::Mat(), right_features_);
  });
  extractor.extract(left, ignore, frame.features);
  other.get();
}

void StereoDepth::depth(const cv::Mat& left, const cv::Mat& right, Frame& frame) {
  if (parts_.calibration == nullptr) {
    matcher_.match(left, right, right_features_, frame);
    return;
  }
  matcher_.match(left, right, right_features_, frame, parts_.calibration->begin_frame());
  // Rows that turn out wrong make columns wrong, because patches are compared in them.
  if (parts_.calibration->learn_rows(matcher_.row_differences()))
    matcher_.match(left, right, right_features_, frame, parts_.calibration->begin_frame());
}

bool StereoDepth::is_exchanged(const cv::Mat& left, const cv::Mat& right, const Frame& frame) {
  constexpr std::size_t least_features = 30, least_ratio = 3;
  const auto with_depth = [](const Frame& any) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < any.size(); ++i) count += any.has_depth(i) ? 1 : 0;
    return count;
  };
  Frame other;
  other.camera = frame.camera;
  other.pyramid = frame.pyramid;
  other.features = right_features_;
  other.x = right_features_.x, other.y = right_features_.y;
  matcher_.match(right, left, frame.features, other);
  const std::size_t count = with_depth(other);
  return count >= least_features && count >= least_ratio * with_depth(frame);
}

}  // namespace holdfast
