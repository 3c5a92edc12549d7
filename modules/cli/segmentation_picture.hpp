// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/interfaces/segmenter.hpp"

namespace holdfast {

/// A segmentation for people: the image (8UC3), with a colour on each class, grey on unknown pixels, and the boxes,
/// classes and scores of the instances.
cv::Mat segmentation_picture(const cv::Mat& colour, const Segmentation& segmentation,
                             const std::vector<std::string>& classes);

}  // namespace holdfast
