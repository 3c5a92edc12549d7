// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/features2d.hpp>
#include <vector>

#include "holdfast/core/features.hpp"

/// Shared code of the extractors that OpenCV implements.
namespace holdfast::keypoints {

/// Detects and describes by an extractor of OpenCV, outside `ignore` (8UC1, not 0 = ignored, or empty). Returns false,
/// with nothing found, for images smaller than 32 pixels, which OpenCV's scale spaces do not support. Throws CheckError
/// for images of another type or size. `mask` is a buffer.
bool find_keypoints(cv::Feature2D& extractor, const cv::Mat& grey, const cv::Mat& ignore, cv::Mat& mask,
                    std::vector<cv::KeyPoint>& keypoints, cv::Mat& descriptors);

/// The indices of the `count` keypoints of the largest response, ascending; of equal ones the first.
std::vector<std::uint32_t> strongest_keypoints(const std::vector<cv::KeyPoint>& keypoints, std::size_t count);

/// Resizes `out` and copies positions, angles and responses. Octaves and descriptors are zeros.
void copy_keypoints(const std::vector<cv::KeyPoint>& keypoints, Features& out);

}  // namespace holdfast::keypoints
