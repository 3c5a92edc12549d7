// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/pair_errors.hpp"
#include "holdfast/interfaces/dense_stereo.hpp"
#include "holdfast/tracking/depth_provider.hpp"
#include "holdfast/tracking/stereo_matcher.hpp"

namespace holdfast {

class StereoCalibration;

/// Modules and settings of depth from a stereo pair.
struct StereoParts {
  StereoSettings settings;
  /// Extractor for the right image, configured like the left one; both images are then processed in parallel if the
  /// machine has a second core. nullptr = the left extractor is used for both. Must outlive PairDepth.
  FeatureExtractor* right_features = nullptr;
  bool is_dense = false;         ///< compute a depth image for every frame, for filters and masks
  DenseStereo* dense = nullptr;  ///< dense matcher; nullptr = that of settings.dense. Must outlive PairDepth
  /// Calibration errors, which correct the features and are refined by their row differences; nullptr = no correction.
  /// Must outlive PairDepth.
  StereoCalibration* calibration = nullptr;
};

/// Depth from a rectified pair: of features by StereoMatcher, and of the whole image by a DenseStereo, for every frame
/// with StereoParts::is_dense and otherwise on request. Called by one thread; uses a second one internally.
class PairDepth final : public DepthProvider {
 public:
  /// The camera must have no distortion.
  PairDepth(const Camera& camera, const StereoParts& parts);
  ~PairDepth() override;

  /// False: the rows and columns of both images determine depth.
  bool allows_motion_compensation() const override { return false; }
  void check_images(const SensorFrame& sensor_frame) const override;
  cv::Mat begin(const SensorFrame& sensor_frame, const cv::Mat& grey) override;
  /// Extracts the features of the right image as well.
  void extract(const cv::Mat& grey, const cv::Mat& ignore, FeatureExtractor& extractor, Frame& frame) override;
  void set_budget(double factor) override {
    if (parts_.right_features != nullptr) parts_.right_features->set_budget(factor);
  }
  void read(const SensorFrame& sensor_frame, Frame& frame) override;
  /// True if far more features have a depth with the left and the right image swapped.
  bool is_pair_exchanged(const Frame& frame) override;
  /// The noise of depth grows with its square: there is no depth where its standard deviation exceeds
  /// depth_noise::farther. The right image is corrected by the calibration errors. Empty with DenseStereoMethod::off.
  void add_image(SensorFrame& sensor_frame) override { sensor_frame.depth = image(); }

 private:
  /// The right image, converted at the first call for a frame: by the thread that extracts its features, if there is
  /// one.
  const cv::Mat& grey_right();
  /// The depth image, computed at the first call for a frame.
  const cv::Mat& image();
  cv::Mat compute_image();
  /// The right image as a pair without errors would show it.
  const cv::Mat& corrected_right();

  StereoParts parts_;
  Camera camera_;
  double fx_baseline_;
  StereoMatcher matcher_;
  Features right_features_;
  cv::Mat left_, right_;  // images of the frame: grey, and that of the sensor until grey_right() converts it
  cv::Mat converted_;     // buffer, because images of a sensor frame must not be written to
  std::optional<cv::Mat> image_;
  std::unique_ptr<DenseStereo> own_dense_;
  cv::Mat disparity_, corrected_;
  PairErrors errors_;      // of the maps
  cv::Mat map_x_, map_y_;  // column and row in the right image of each of its pixels in a pair without errors
};

}  // namespace holdfast
