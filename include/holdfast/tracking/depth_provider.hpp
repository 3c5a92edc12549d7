// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"

namespace holdfast {

/// Source of the depth of a frame and its features: a depth image (ImageDepth), a stereo pair (PairDepth), or none
/// (NoDepth). It is chosen once per run. FrameBuilder calls begin(), extract() and read() for each frame, in this
/// order. One thread.
class DepthProvider {
 public:
  virtual ~DepthProvider() = default;

  /// False if no feature has a measured depth.
  virtual bool features_have_depth() const { return true; }
  /// True if features may be moved after read() to compensate the ego-motion within a frame.
  virtual bool allows_motion_compensation() const { return true; }

  /// Throws InputError, with the number of the frame, if the images that depth is measured by are missing or do not
  /// have the type or size of SensorFrame's contract.
  virtual void check_images(const SensorFrame&) const {}
  /// Begins a frame with valid images. `grey`: its (left) image, 8UC1; it must not change before the next frame.
  /// Returns the depth image for dense comparisons (32FC1 [m], 0 = none); empty if frames have none.
  virtual cv::Mat begin(const SensorFrame&, const cv::Mat& grey) = 0;
  /// Extracts the features of `grey` into frame.features, except where `ignore` (8UC1 or empty) is not 0.
  virtual void extract(const cv::Mat& grey, const cv::Mat& ignore, FeatureExtractor& extractor, Frame& frame) {
    extractor.extract(grey, ignore, frame.features);
  }
  /// Multiplies the number of further features that depth needs (FeatureExtractor::set_budget). The caller sets that of
  /// the (left) image.
  virtual void set_budget(double) {}
  /// Sets frame.depth and frame.right_x of all features, without compensation of ego-motion.
  virtual void read(const SensorFrame&, Frame& frame) = 0;
  /// Sets them with compensation of the motion between the exposures of the colour and the depth image. Has no effect
  /// without a depth image.
  virtual void align(const SensorFrame&, const Eigen::Isometry3d& /*T_depth_colour*/, Frame&) {}

  /// True if matches indicate that the left and the right image of the frame are swapped.
  virtual bool is_pair_exchanged(const Frame&) { return false; }
  /// Sets the depth image of the frame of the last begin() if it has to be computed; the caller must not write to it.
  virtual void add_image(SensorFrame&) {}
};

}  // namespace holdfast
