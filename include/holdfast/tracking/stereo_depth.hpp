// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "holdfast/core/frame.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/tracking/stereo_matcher.hpp"

namespace cv {
class StereoSGBM;
}

namespace holdfast {

class StereoCalibration;

/// Where the depth of frames comes from when a camera has a right image in place of a depth image.
struct StereoParts {
  StereoSettings settings;
  /// Of the right image, equal to that of the left one. With one of its own, both images are searched at the same time
  /// where the machine has a second core; nullptr: the left one's, afterwards. It must outlive the reader.
  FeatureExtractor* right_features = nullptr;
  bool is_dense = false;  ///< filters and masks need a depth image
  /// Errors of the calibration, by which features are corrected, and which learn their rows; nullptr: there are none.
  /// It must outlive the reader.
  StereoCalibration* calibration = nullptr;
};

/// Depth from a rectified pair: of the features by StereoMatcher, and, if it is wanted, of the whole image by
/// semi-global matching (Hirschmueller 2008, in OpenCV's version) at half the resolution. One thread, which waits for a
/// second one of its own.
class StereoDepth {
 public:
  StereoDepth(const Camera& camera, const StereoParts& parts);

  /// The depth image of a pair of 8UC1 images: 32FC1 [m] of the same size, 0 = none; blocks of 2 x 2 pixels have one
  /// depth. Empty unless parts.is_dense. Valid until the next call.
  const cv::Mat& dense(const cv::Mat& left, const cv::Mat& right);
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
  double fx_baseline_;
  StereoMatcher matcher_;
  Features right_features_;
  cv::Ptr<cv::StereoSGBM> dense_matcher_;  // none unless parts_.is_dense
  cv::Mat half_left_, half_right_, disparity_, dense_;
};

}  // namespace holdfast
