// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/pair_errors.hpp"
#include "holdfast/interfaces/dense_stereo.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/tracking/stereo_matcher.hpp"

namespace holdfast {

class StereoCalibration;

/// Where the depth of frames comes from when a camera has a right image in place of a depth image.
struct StereoParts {
  StereoSettings settings;
  /// Of the right image, equal to that of the left one. With one of its own, both images are searched at the same time
  /// where the machine has a second core; nullptr: the left one's, afterwards. It must outlive the reader.
  FeatureExtractor* right_features = nullptr;
  bool is_dense = false;         ///< every frame gets a depth image, for filters and masks
  DenseStereo* dense = nullptr;  ///< in place of that of settings.dense; it must outlive the reader
  /// Errors of the calibration, by which features are corrected, and which learn their rows; nullptr: there are none.
  /// It must outlive the reader.
  StereoCalibration* calibration = nullptr;
};

/// Depth from a rectified pair: of the features by StereoMatcher, and of the whole image by a DenseStereo. One thread,
/// which waits for a second one of its own.
class StereoDepth {
 public:
  StereoDepth(const Camera& camera, const StereoParts& parts);
  ~StereoDepth();

  bool is_dense() const { return parts_.is_dense; }
  /// A depth image of a pair of 8UC1 images: 32FC1 [m] of the same size, 0 = none. The right image is corrected by the
  /// errors of the calibration. The noise of depth grows with its square: no depth where its standard deviation exceeds
  /// depth_noise::farther. Empty with DenseStereoMethod::off.
  cv::Mat depth_image(const cv::Mat& left, const cv::Mat& right);
  /// The number of features of the right image, as FeatureExtractor::set_budget; that of the left one is the caller's.
  void set_budget(double factor) {
    if (parts_.right_features != nullptr) parts_.right_features->set_budget(factor);
  }
  /// Extracts the features of both images, those of the left one by `extractor` into frame.features without those where
  /// `ignore` is not 0. depth() is next.
  void extract(const cv::Mat& left, const cv::Mat& right, const cv::Mat& ignore, FeatureExtractor& extractor,
               Frame& frame);
  /// Writes frame.depth and frame.right_x.
  void depth(const cv::Mat& left, const cv::Mat& right, Frame& frame);
  /// Whether far more features have a depth if the images of the pair of the last call of depth() are exchanged.
  bool is_exchanged(const cv::Mat& left, const cv::Mat& right, const Frame& frame);

 private:
  StereoParts parts_;
  Camera camera_;
  double fx_baseline_;
  StereoMatcher matcher_;
  Features right_features_;
  /// The right image as a pair without errors would show it.
  const cv::Mat& corrected(const cv::Mat& right);

  std::unique_ptr<DenseStereo> own_dense_;
  cv::Mat disparity_, corrected_;
  PairErrors errors_;      // of the maps
  cv::Mat map_x_, map_y_;  // column and row in the right image of each of its pixels in a pair without errors
};

}  // namespace holdfast
