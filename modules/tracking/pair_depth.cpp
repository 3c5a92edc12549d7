// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/pair_depth.hpp"

#include <algorithm>
#include <future>
#include <opencv2/imgproc.hpp>
#include <string>
#include <thread>

#include "eight_words.hpp"
#include "holdfast/core/depth_noise.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/size_text.hpp"
#include "holdfast/core/stereo_calibration.hpp"
#include "holdfast/core/thread_name.hpp"
#include "semi_global_stereo.hpp"

namespace holdfast {

PairDepth::PairDepth(const Camera& camera, const StereoParts& parts)
    : parts_(parts), camera_(camera), fx_baseline_(camera.fx * camera.baseline), matcher_(parts.settings) {}
PairDepth::~PairDepth() = default;

void PairDepth::check_images(const SensorFrame& sensor_frame) const {
  const cv::Mat& right = sensor_frame.right;
  if ((right.type() != CV_8UC1 && right.type() != CV_8UC3) || right.size() != sensor_frame.colour.size())
    throw InputError({"frame " + std::to_string(sensor_frame.index)},
                     right.empty() ? std::string("has no right image; expected one in every frame of a stereo pair")
                                   : "the right image is " + size_text(right.cols, right.rows) + " with " +
                                         std::to_string(right.channels()) +
                                         " channels; expected 1 or 3 channels of 8 bit, of the left image's size");
}

cv::Mat PairDepth::begin(const SensorFrame& sensor_frame, const cv::Mat& grey) {
  left_ = grey;
  right_ = sensor_frame.right;
  image_.reset();
  return parts_.is_dense ? image() : cv::Mat();
}

const cv::Mat& PairDepth::grey_right() {
  if (right_.channels() == 3) {
    cv::cvtColor(right_, converted_, cv::COLOR_BGR2GRAY);
    right_ = converted_;
  }
  return right_;
}

const cv::Mat& PairDepth::image() {
  if (!image_) image_ = compute_image();
  return *image_;
}

const cv::Mat& PairDepth::corrected_right() {
  const PairErrors errors = parts_.calibration != nullptr ? parts_.calibration->errors() : PairErrors();
  const cv::Mat& right = grey_right();
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

namespace {

/// Depth of one or several disparities, and 0 where they are less than `least` or depth is too uncertain.
template <class Floats>
HOLDFAST_INLINE Floats depth_of(const Floats& disparity, float numerator, float least) {
  constexpr float noise = 0.17F;  // px; standard deviation of disparities
  const auto is_measured = disparity >= least;
  const Floats z = numerator / (is_measured ? disparity : Floats{} + 1.0F);
  const auto is_certain = z * noise <= (depth_noise::farther.offset + depth_noise::farther.slope * z) * disparity;
  return (is_measured & is_certain) ? z : Floats{};
}

}  // namespace

cv::Mat PairDepth::compute_image() {
  if (parts_.settings.dense == DenseStereoMethod::off) return {};
  if (parts_.dense == nullptr) {
    own_dense_ = std::make_unique<SemiGlobalStereo>(fx_baseline_ / parts_.settings.minimum_depth, camera_.width);
    parts_.dense = own_dense_.get();
  }
  parts_.dense->match(left_, corrected_right(), disparity_);
  constexpr int lanes = sizeof(FourFloats) / sizeof(float);
  cv::Mat depth(left_.size(), CV_32FC1);
  const auto numerator = static_cast<float>(fx_baseline_);
  const auto least = static_cast<float>(parts_.settings.minimum_disparity);
  for (int row = 0; row < depth.rows; ++row) {
    const float* from = disparity_.ptr<float>(row);
    float* to = depth.ptr<float>(row);
    int column = 0;
    for (; column + lanes <= depth.cols; column += lanes)
      store(depth_of(lanes_at<FourFloats>(from + column), numerator, least), to + column);
    for (; column < depth.cols; ++column) to[column] = depth_of(from[column], numerator, least);
  }
  return depth;
}

void PairDepth::extract(const cv::Mat& grey, const cv::Mat& ignore, FeatureExtractor& extractor, Frame& frame) {
  static const unsigned cores = std::thread::hardware_concurrency();  // reads a file
  if (parts_.right_features == nullptr || cores < 2) {
    extractor.extract(grey, ignore, frame.features);
    (parts_.right_features != nullptr ? *parts_.right_features : extractor)
        .extract(grey_right(), cv::Mat(), right_features_);
    return;
  }
  std::future<void> other = std::async(std::launch::async, [&] {
    name_this_thread("right features");
    parts_.right_features->extract(grey_right(), cv::Mat(), right_features_);
  });
  extractor.extract(grey, ignore, frame.features);
  other.get();
}

void PairDepth::read(const SensorFrame&, Frame& frame) {
  if (parts_.calibration == nullptr) {
    matcher_.match(left_, grey_right(), right_features_, frame);
    return;
  }
  matcher_.match(left_, grey_right(), right_features_, frame, parts_.calibration->begin_frame());
  // Rows that turn out wrong make columns wrong, because patches are compared in them.
  if (parts_.calibration->learn_rows(matcher_.row_differences()))
    matcher_.match(left_, grey_right(), right_features_, frame, parts_.calibration->begin_frame());
}

bool PairDepth::is_pair_exchanged(const Frame& frame) {
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
  matcher_.match(grey_right(), left_, frame.features, other);
  const std::size_t count = with_depth(other);
  return count >= least_features && count >= least_ratio * with_depth(frame);
}

}  // namespace holdfast
