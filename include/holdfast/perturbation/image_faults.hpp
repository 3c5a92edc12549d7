// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "holdfast/core/random.hpp"

namespace holdfast {

// Faults of single images. All functions return new images and leave their argument unchanged. Their results are the
// same on every machine: they compute in integers, or in single operations on floats.

/// 8UC1 or 8UC3 times a factor, rounded and saturated.
cv::Mat scaled_brightness(const cv::Mat& image, double factor);
/// 8UC1 or 8UC3 with normal noise in every channel.
cv::Mat with_noise(const cv::Mat& image, double standard_deviation, Random random);
/// 8UC1 or 8UC3: the mean along a line through each pixel, of this length [px] and direction [rad]. The border is
/// repeated outside of the image.
cv::Mat blurred(const cv::Mat& image, double length, double direction);
/// Rows shifted to the right by -shift / 2 (first row) to shift / 2 (last row) [px], the border repeated. 8UC1 and 8UC3
/// are interpolated.
cv::Mat sheared(const cv::Mat& image, double shift);
/// The same for depth (32FC1) and labels (8UC1): shifts are rounded, and what comes from outside of the image is 0.
cv::Mat sheared_values(const cv::Mat& image, double shift);
/// Moved by whole pixels to the right and down; what comes from outside of the image is 0. Any type.
cv::Mat shifted(const cv::Mat& image, int columns, int rows);
/// Depth (32FC1) times a factor.
cv::Mat scaled_depth(const cv::Mat& depth, double factor);
/// Depth (32FC1) in which elliptic patches that cover this share of the image are 0.
cv::Mat with_holes(const cv::Mat& depth, double share, Random random);
/// A random texture of coloured blocks, 8UC3.
cv::Mat block_texture(int width, int height, int block, Random random);

}  // namespace holdfast
