// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/inference/object_layout.hpp"

namespace holdfast {

/// An object that a network found in its input.
struct Detection {
  int class_number = 0;                  ///< of the network, without the background
  float score = 0.0F;                    ///< 0 to 1
  cv::Rect2f box;                        ///< in the network's input [px], within it
  std::vector<float> mask_coefficients;  ///< one for each prototype; empty without prototypes
  int number = 0;                        ///< of its box in the outputs
};

/// Decodes the outputs of a network for objects (32F) to the objects with a score of at least `min_score`, by
/// decreasing score, in case of a tie by their number in the output. At most 3000; boxes without area inside the input
/// are left out. `names` is the number of classes that have a name. Throws InputError, which states what was found and
/// what was expected, for outputs of other shapes than the layout's, scores that are no probabilities, numbers that are
/// not finite, and class numbers without a name. `model` names the network in messages.
std::vector<Detection> decode_objects(const std::vector<cv::Mat>& outputs, const ObjectLayout& layout,
                                      const cv::Size& input, double min_score, int names,
                                      const std::filesystem::path& model);

/// Intersection over union of two boxes; 0 if both are empty.
double overlap(const cv::Rect2f& a, const cv::Rect2f& b);

/// Greedy non-maximum suppression within each class: removes an object that overlaps one of a higher score by more than
/// `max_overlap`; keeps the order. At most `most` are kept. With a `max_overlap` of 1 nothing is suppressed.
void suppress_duplicates(std::vector<Detection>& objects, double max_overlap, std::size_t most = 300);

}  // namespace holdfast
