// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/stereo_depth.hpp"

#include <algorithm>
#include <future>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "holdfast/core/depth_noise.hpp"
#include "holdfast/core/stereo_calibration.hpp"
#include "holdfast/core/thread_name.hpp"
#include "semi_global_stereo.hpp"

namespace holdfast {

StereoDepth::StereoDepth(const Camera& camera, const StereoParts& parts)
    : parts_(parts), camera_(camera), fx_baseline_(camera.fx * camera.baseline), matcher_(parts.settings) {}
StereoDepth::~StereoDepth() = default;

const cv::Mat& StereoDepth::corrected(const cv::Mat& right) {
  const PairErrors errors = parts_.calibration != nullptr ? parts_.calibration->errors() : PairErrors();
  if (errors == PairErrors()) return right;
  if (map_x_.empty() || !(errors == errors_)) {
    errors_ = errors;
    map_x_.create(right.size(), CV_32FC1), map_y_.create(right.size(), CV_32FC1);
    for (int y = 0; y < right.rows; ++y)
      for (int x = 0; x < right.cols; ++x) {
        map_x_.ptr<float>(y)[x] = static_cast<float>(x + errors.column(camera_, x, y));
        map_y_.ptr<float>(y)[x] = static_cast<float>(y + errors.row(camera_, x, y));
      }
  }
  cv::remap(right, corrected_, map_x_, map_y_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return corrected_;
}

cv::Mat StereoDepth::depth_image(const cv::Mat& left, const cv::Mat& right) {
  if (parts_.settings.dense == DenseStereoMethod::off) return {};
  if (parts_.dense == nullptr) {
    own_dense_ = std::make_unique<SemiGlobalStereo>(fx_baseline_ / parts_.settings.minimum_depth, camera_.width);
    parts_.dense = own_dense_.get();
  }
  parts_.dense->match(left, corrected(right), disparity_);
  constexpr float noise = 0.17F;  // px; standard deviation of disparities
  cv::Mat depth(left.size(), CV_32FC1);
  const auto numerator = static_cast<float>(fx_baseline_);
  const auto least = static_cast<float>(parts_.settings.minimum_disparity);
  for (int row = 0; row < depth.rows; ++row) {
    const float* from = disparity_.ptr<float>(row);
    float* to = depth.ptr<float>(row);
    for (int column = 0; column < depth.cols; ++column) {
      const float z = from[column] >= least ? numerator / from[column] : 0.0F;
      to[column] = z * noise <= depth_noise::farther(z) * from[column] ? z : 0.0F;
    }
  }
  return depth;
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
