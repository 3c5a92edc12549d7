// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace holdfast {

/// What became of one class, over all images. A figure of nothing (no pixel, no image) is NaN.
struct ClassEvaluation {
  std::string name;
  std::uint64_t true_pixels = 0;                        ///< that the labels give to the class
  std::uint64_t found_pixels = 0;                       ///< that the predictions give to it, where the labels are known
  std::uint64_t both = 0;                               ///< that both give to it
  std::size_t images = 0;                               ///< whose labels show it
  std::size_t detected = 0;                             ///< of them those where its IoU is above 0.5
  std::uint64_t boundary_union = 0, boundary_both = 0;  ///< pixels of the two outlines

  /// Intersection over union of the pixels of all images.
  double iou() const;
  /// Correctly labelled pixels / true pixels: equation 1 of Zeng et al. (Remote Sens. 2023, 15, 5479).
  double accuracy() const;
  /// Share of the images that show the class in which its IoU is above 0.5: the rule of the same paper, with the class
  /// in an image as the object.
  double detection_rate() const;
  /// Intersection over union of the outlines: the pixels of a region at most 2 % of the image's diagonal from what is
  /// not the region, the image's outside included (Cheng et al., CVPR 2021), of all images together.
  double boundary_iou() const;
  /// Found to be of the class, and are not.
  std::uint64_t false_pixels() const { return found_pixels - both; }
};

/// How well predicted labels agree with the truth.
struct SegmentationEvaluation {
  std::vector<ClassEvaluation> classes;  ///< by label; the first is the background
  std::size_t images = 0;
  std::uint64_t known_pixels = 0;  ///< with a true label
  std::uint64_t correct_pixels = 0;

  double overall_accuracy() const;
  /// Over the classes that the labels show at all.
  double mean_iou() const;
  double mean_accuracy() const;
};

/// Counts image by image.
class SegmentationEvaluator {
 public:
  /// Names by label; the first is the background. Outlines, which take most of the time, are compared for the class
  /// with the name `outlined` only; empty = for none.
  explicit SegmentationEvaluator(std::vector<std::string> classes, const std::string& outlined = "person");

  /// Labels and predictions of one image: 8UC1 of the same size, index into the classes. Where the labels are unknown
  /// (255) nothing is counted. An unknown prediction is wrong, and a find of no class. Throws CheckError for another
  /// type, size or number.
  void add(const cv::Mat& labels, const cv::Mat& predictions);

  const SegmentationEvaluation& result() const { return result_; }

 private:
  SegmentationEvaluation result_;
  std::size_t outlined_;  ///< label; as large as the number of classes for none
};

/// A table to read on a terminal, ends with a newline.
std::string to_text(const SegmentationEvaluation& evaluation);
/// The same figures in full precision; a figure of nothing is null.
std::string to_json(const SegmentationEvaluation& evaluation);

}  // namespace holdfast
