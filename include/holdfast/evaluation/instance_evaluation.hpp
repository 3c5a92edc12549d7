// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace holdfast {

/// Instances of an image, true or found: 16UC1, 0 = none, k = instance k, with the label and the score of instance k in
/// entry k - 1.
struct InstanceImage {
  /// Class and score of an instance.
  struct Entry {
    std::uint8_t label = 0;  ///< index into the classes; 0 and 255 do not count
    float score = 1.0F;
  };
  cv::Mat instances;
  std::vector<Entry> entries;
};

/// Number of the thresholds of intersection over union of average precision: 0.5, 0.55, ... 0.95.
inline constexpr std::size_t instance_threshold_count = 10;

/// Accuracy of the instances of one class over all images. A figure without instances is NaN.
struct ClassInstanceEvaluation {
  std::string name;
  std::size_t true_instances = 0, found_instances = 0;
  std::size_t matched = 0;   ///< pairs with an intersection over union above 0.5
  double matched_iou = 0.0;  ///< sum over these pairs
  /// Average precision at each threshold: mean of the precision at the recalls 0, 0.01, ... 1 (COCO, Lin et al. 2014).
  std::array<double, instance_threshold_count> average_precision{};

  double ap50() const { return average_precision.front(); }
  /// Mean of the average precision over the thresholds 0.5 to 0.95.
  double ap() const;
  /// Panoptic quality of things: matched_iou / (matched + half of the instances without counterpart); equation 1 of
  /// Kirillov et al., Panoptic segmentation, CVPR 2019.
  double panoptic_quality() const;
};

/// Agreement of found instances with the true ones.
struct InstanceEvaluation {
  std::vector<ClassInstanceEvaluation> classes;  ///< by label; the background has no instances
  std::size_t images = 0;

  /// Means over the classes that have true instances.
  double mean_ap50() const;
  double mean_ap() const;
  double mean_panoptic_quality() const;
};

/// Accumulates the evaluation of instances image by image.
class InstanceEvaluator {
 public:
  /// `classes` are names by label; the first is the background.
  explicit InstanceEvaluator(std::vector<std::string> classes);

  /// Adds an image. `is_known` (8UC1, or empty = everywhere) is 0 where the truth is unknown; these pixels belong to no
  /// instance. A found instance without pixels is a wrong one; a true one without pixels does not count. Throws
  /// CheckError for a wrong type, size or label, and for numbers without an entry.
  void add(const InstanceImage& truth, const InstanceImage& found, const cv::Mat& is_known = {});

  InstanceEvaluation result() const;

 private:
  /// A found instance and the thresholds at which it is a true positive.
  struct Find {
    float score = 0.0F;
    std::uint16_t is_right = 0;  ///< a bit for each threshold
  };

  InstanceEvaluation result_;
  std::vector<std::vector<Find>> finds_;  ///< by label
};

/// Formats the result as a table for a terminal; ends with a newline.
std::string to_text(const InstanceEvaluation& evaluation);

}  // namespace holdfast
