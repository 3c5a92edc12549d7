// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace holdfast {

/// Depth of 32FC1 [m] as whole numbers of 16 bits, `factor` to the metre, rounded to the nearest; what does not fit has
/// no value, 0.
cv::Mat to_depth_units(const cv::Mat& depth, double factor);
/// Whole numbers as a source reads them from a PNG: 32FC1 [m], each the float nearest to the quotient.
cv::Mat depth_of_units(const cv::Mat& units, double factor);

/// The first of `factors` with which the whole numbers give back every value of the image, or 0 if there is none.
double exact_depth_factor(const cv::Mat& depth, const std::vector<double>& factors);

/// Whether two depth images of one size have the same values.
bool is_same_depth(const cv::Mat& a, const cv::Mat& b);

}  // namespace holdfast
