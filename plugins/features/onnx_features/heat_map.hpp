// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace holdfast::onnx_features_plugin {

/// A keypoint of a heat map, in its pixels.
struct HeatPoint {
  float x = 0.0F, y = 0.0F;
  float score = 0.0F;
};

/// Which maxima of a heat map are keypoints.
struct HeatMapSettings {
  float threshold = 0.005F;    ///< minimum score
  int suppression_radius = 4;  ///< of the square in which a keypoint has the largest score [px]
  int border = 4;              ///< [px]
  bool subpixel = true;        ///< a parabola through the neighbours in each direction gives the position
  std::size_t count = 1000;    ///< the best are kept
};

/// Turns the output of a network into one score per pixel, 32FC1: 1 x 1 x height x width as it is, and 1 x (n * n + 1)
/// x rows x columns, the cells of n x n pixels of SuperPoint, by a softmax over the channels, the last of which stands
/// for "no keypoint" (DeTone, Malisiewicz, Rabinovich, "SuperPoint: self-supervised interest point detection and
/// description", CVPR workshops 2018, section 3.2). Returns an empty image for other shapes.
cv::Mat heat_map_of(const cv::Mat& output);

/// The keypoints of a heat map in reading order. Of equal neighbours the first in reading order is the maximum.
std::vector<HeatPoint> keypoints_of(const cv::Mat& heat, const HeatMapSettings& settings);

}  // namespace holdfast::onnx_features_plugin
