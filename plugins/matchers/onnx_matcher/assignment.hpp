// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace holdfast::onnx_matcher_plugin {

/// Two features that a network assigned to each other.
struct Assigned {
  std::uint32_t row = 0, column = 0;
  float probability = 0.0F;
};

/// Replaces scores of any size (32FC1) by the product of their softmax over the rows and that over the columns (Sun et
/// al., "LoFTR: detector-free local feature matching with transformers", CVPR 2021, equation 2).
void dual_softmax(cv::Mat& scores);

/// The entries that are the largest of their row and of their column and at least `threshold`, ordered by column. Of
/// equal ones the first is the largest.
std::vector<Assigned> mutual_best(const cv::Mat& probabilities, float threshold);

}  // namespace holdfast::onnx_matcher_plugin
