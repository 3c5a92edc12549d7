// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/evaluation/instance_evaluation.hpp"

namespace holdfast {

/// Predictions whose confidence lies in one interval.
struct ConfidenceBin {
  std::uint64_t pixels = 0;
  std::uint64_t correct = 0;
  double confidence = 0.0;  ///< sum over the pixels, each from 0 to 1
};

/// Segmentation accuracy of one class over all images. A figure without pixels or images is NaN.
struct ClassEvaluation {
  std::string name;
  std::uint64_t true_pixels = 0;                        ///< pixels labelled with the class
  std::uint64_t found_pixels = 0;                       ///< pixels predicted as the class, among labelled pixels
  std::uint64_t both = 0;                               ///< pixels labelled with and predicted as the class
  std::size_t images = 0;                               ///< images whose labels contain the class
  std::size_t detected = 0;                             ///< of these, images in which its IoU is above 0.5
  std::uint64_t boundary_union = 0, boundary_both = 0;  ///< pixels of the two boundaries
  /// The labelled pixels that were predicted as the class, in confidence_bin_count intervals of equal width from 0 to 1
  /// (reliability diagram); empty where predictions came without confidence.
  std::vector<ConfidenceBin> confidence_bins;

  /// Intersection over union (IoU) of the pixels of all images.
  double iou() const;
  /// Correctly labelled pixels / true pixels: equation 1 of Zeng et al. (Remote Sens. 2023, 15, 5479).
  double accuracy() const;
  /// Fraction of the images with the class in which its IoU is above 0.5: the rule of the same paper, applied to the
  /// class in an image as the object.
  double detection_rate() const;
  /// IoU of the boundaries over all images. The boundary of a region consists of its pixels within 2 % of the image
  /// diagonal of a pixel outside the region or of the image border (Cheng et al., CVPR 2021).
  double boundary_iou() const;
  /// Expected calibration error of the predictions of the class: the mean over their pixels of the difference, per
  /// interval of confidence, between mean confidence and share of correct predictions (Guo et al., On calibration of
  /// modern neural networks, ICML 2017, equation 3).
  double calibration_error() const;
  /// Pixels wrongly predicted as the class.
  std::uint64_t false_pixels() const { return found_pixels - both; }
};

inline constexpr std::size_t confidence_bin_count = 20;

/// Agreement of predicted labels with the ground truth.
struct SegmentationEvaluation {
  std::vector<ClassEvaluation> classes;  ///< by label; the first is the background
  std::size_t images = 0;
  std::uint64_t known_pixels = 0;  ///< pixels with a ground-truth label
  std::uint64_t correct_pixels = 0;

  double overall_accuracy() const;
  /// Mean over the classes that occur in the labels.
  double mean_iou() const;
  double mean_accuracy() const;
};

/// Accumulates the evaluation image by image.
class SegmentationEvaluator {
 public:
  /// `classes` are names by label; the first is the background. Boundaries, which take most of the time, are evaluated
  /// for the class named `outlined` only; empty = for none.
  explicit SegmentationEvaluator(std::vector<std::string> classes, const std::string& outlined = "person");

  /// Adds labels and predictions of one image: 8UC1 of the same size, index into the classes. Pixels with unknown
  /// labels (255) are ignored. An unknown prediction is wrong and belongs to no class. `confidence` is empty or 8UC1 of
  /// the same size, 255 = certain. Throws CheckError for a wrong type, size or label.
  void add(const cv::Mat& labels, const cv::Mat& predictions, const cv::Mat& confidence = {});

  const SegmentationEvaluation& result() const { return result_; }

 private:
  SegmentationEvaluation result_;
  std::size_t outlined_;  ///< label; as large as the number of classes for none
};

/// Formats the result as a table for a terminal; ends with a newline.
std::string to_text(const SegmentationEvaluation& evaluation);
/// Formats the result as JSON in full precision; a figure without pixels, images or instances is null. `instances`, if
/// there are any, become its member "instances".
std::string to_json(const SegmentationEvaluation& evaluation,
                    const std::optional<InstanceEvaluation>& instances = std::nullopt);

}  // namespace holdfast
