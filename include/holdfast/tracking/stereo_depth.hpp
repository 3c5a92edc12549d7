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

/// Modules and settings of depth from a stereo pair.
struct StereoParts {
  StereoSettings settings;
  /// Extractor for the right image, configured like the left one; both images are then processed in parallel if the
  /// machine has a second core. nullptr = the left extractor is used for both. Must outlive the reader.
  FeatureExtractor* right_features = nullptr;
  bool is_dense = false;  ///< compute a depth image, for filters and masks
  /// Calibration errors, which correct the features and are refined by their row differences; nullptr = no correction.
  /// Must outlive the reader.
  StereoCalibration* calibration = nullptr;
};

/// Depth from a rectified pair: of features by StereoMatcher and, with StereoParts::is_dense, of the whole image by
/// semi-global matching (Hirschmueller 2008, implementation of OpenCV) at half the resolution. Called by one thread;
/// uses a second one internally.
class StereoDepth {
 public:
  StereoDepth(const Camera& camera, const StereoParts& parts);

  /// The depth image of a pair of 8UC1 images: 32FC1 [m] of the same size, 0 = none; blocks of 2 x 2 pixels have one
  /// depth. Empty unless parts.is_dense. Valid until the next call.
  const cv::Mat& dense(const cv::Mat& left, const cv::Mat& right);
  /// Multiplies the number of features of the right image (FeatureExtractor::set_budget). The caller sets that of the
  /// left one.
  void set_budget(double factor) {
    if (parts_.right_features != nullptr) parts_.right_features->set_budget(factor);
  }
  /// Extracts the features of both images; those of the left one by `extractor` into frame.features, except where
  /// `ignore` is not 0. Must be followed by depth().
  void extract(const cv::Mat& left, const cv::Mat& right, const cv::Mat& ignore, FeatureExtractor& extractor,
               Frame& frame);
  /// Writes frame.depth and frame.right_x.
  void depth(const cv::Mat& left, const cv::Mat& right, Frame& frame);
  /// True if far more features have a depth with the left and the right image of the last depth() swapped.
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
