// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace holdfast {

/// What a source knows beyond the images, when it knows it: for exact segmenters, evaluation and tests.
struct FrameTruth {
  std::optional<Eigen::Isometry3d> T_world_camera;
  cv::Mat object_mask;   ///< 8UC1, 0 = static world, k = object k; empty when unknown
  cv::Mat class_labels;  ///< 8UC1, index into the source's class names; empty when unknown
  /// Numbers in object_mask, rising, of the objects whose surface moves at this moment; the others could but do not.
  std::vector<std::uint8_t> moving_objects;
};

/// One pair of images from a camera. The images are shared, never copied, and must not be written to.
struct SensorFrame {
  std::uint64_t index = 0;  ///< number of the frame in its source, from 0, skipped frames counted
  double timestamp = 0.0;   ///< of the colour image [s]
  cv::Mat colour;           ///< 8UC3, blue green red
  cv::Mat depth;            ///< 32FC1 along the optical axis [m], 0 = no value; same size as colour; may be empty
  std::shared_ptr<const FrameTruth> truth;  ///< nullptr when the source knows nothing
};

}  // namespace holdfast
