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

/// Modules and settings of depth from a stereo pair.
struct StereoParts {
  StereoSettings settings;
  /// Extractor for the right image, configured like the left one; both images are then processed in parallel if the
  /// machine has a second core. nullptr = the left extractor is used for both. Must outlive the reader.
  FeatureExtractor* right_features = nullptr;
  bool is_dense = false;         ///< compute a depth image for every frame, for filters and masks
  DenseStereo* dense = nullptr;  ///< dense matcher; nullptr = that of settings.dense. Must outlive the reader
  /// Calibration errors, which correct the features and are refined by their row differences; nullptr = no correction.
  /// Must outlive the reader.
  StereoCalibration* calibration = nullptr;
};

/// Depth from a rectified pair: of features by StereoMatcher, and of the whole image by a DenseStereo. Called by one
/// thread; uses a second one internally.
class StereoDepth {
 public:
  StereoDepth(const Camera& camera, const StereoParts& parts);
  ~StereoDepth();

  bool is_dense() const { return parts_.is_dense; }
  /// The depth image of a pair of 8UC1 images: 32FC1 [m] of the same size, 0 = none. The right image is corrected by
  /// the calibration errors. The noise of depth grows with its square: there is no depth where its standard deviation
  /// exceeds depth_noise::farther. Empty with DenseStereoMethod::off.
  cv::Mat depth_image(const cv::Mat& left, const cv::Mat& right);
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
