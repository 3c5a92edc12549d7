// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/segmentation_evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast {

namespace {

constexpr double share_of_diagonal = 0.02;
constexpr double detection_threshold = 0.5;

double ratio(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(part) / static_cast<double>(whole);
}

/// 1 for the pixels of `label`, where the truth is known.
cv::Mat region(const cv::Mat& image, const cv::Mat& labels, std::uint8_t label) {
  cv::Mat mask(image.size(), CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    const auto* value = image.ptr<std::uint8_t>(y);
    const auto* truth = labels.ptr<std::uint8_t>(y);
    auto* to = mask.ptr<std::uint8_t>(y);
    for (int x = 0; x < image.cols; ++x) to[x] = truth[x] != CellMask::unknown && value[x] == label;
  }
  return mask;
}

/// The pixels of a region that have something else, or the image's border, within `reach` pixels (along rows, columns
/// and diagonals alike), as `reach` erosions by 3x3 pixels find them. Sums over squares tell which pixels remain.
cv::Mat outline(const cv::Mat& mask, int reach) {
  const int width = mask.cols, height = mask.rows;
  cv::Mat sums = cv::Mat::zeros(height + 1, width + 1, CV_32SC1);
  for (int y = 0; y < height; ++y) {
    int row = 0;
    for (int x = 0; x < width; ++x) {
      row += mask.at<std::uint8_t>(y, x);
      sums.at<int>(y + 1, x + 1) = sums.at<int>(y, x + 1) + row;
    }
  }
  const int side = 2 * reach + 1;
  cv::Mat result = mask.clone();
  for (int y = reach; y + reach < height; ++y)
    for (int x = reach; x + reach < width; ++x) {
      const int top = y - reach, left = x - reach;
      const int inside = sums.at<int>(top + side, left + side) - sums.at<int>(top, left + side) -
                         sums.at<int>(top + side, left) + sums.at<int>(top, left);
      if (inside == side * side) result.at<std::uint8_t>(y, x) = 0;
    }
  return result;
}

void compare_outlines(const cv::Mat& labels, const cv::Mat& predictions, std::uint8_t label, ClassEvaluation& result) {
  const double diagonal = std::hypot(labels.cols, labels.rows);
  const int reach = std::max(1, static_cast<int>(std::lround(share_of_diagonal * diagonal)));
  const cv::Mat truth = outline(region(labels, labels, label), reach);
  const cv::Mat found = outline(region(predictions, labels, label), reach);
  for (int y = 0; y < truth.rows; ++y)
    for (int x = 0; x < truth.cols; ++x) {
      const bool is_true = truth.at<std::uint8_t>(y, x) != 0, is_found = found.at<std::uint8_t>(y, x) != 0;
      result.boundary_union += is_true || is_found;
      result.boundary_both += is_true && is_found;
    }
}

void add_confidence(const cv::Mat& labels, const cv::Mat& predictions, const cv::Mat& confidence,
                    std::vector<ClassEvaluation>& classes) {
  for (ClassEvaluation& one : classes) one.confidence_bins.resize(confidence_bin_count);
  for (int y = 0; y < labels.rows; ++y) {
    const auto* label = labels.ptr<std::uint8_t>(y);
    const auto* prediction = predictions.ptr<std::uint8_t>(y);
    const auto* certainty = confidence.ptr<std::uint8_t>(y);
    for (int x = 0; x < labels.cols; ++x) {
      if (label[x] == CellMask::unknown || prediction[x] == CellMask::unknown) continue;
      ConfidenceBin& bin = classes[prediction[x]].confidence_bins[certainty[x] * confidence_bin_count / 256];
      ++bin.pixels;
      bin.correct += label[x] == prediction[x];
      bin.confidence += certainty[x] / 255.0;
    }
  }
}

}  // namespace

double ClassEvaluation::calibration_error() const {
  double difference = 0.0;
  std::uint64_t pixels = 0;
  for (const ConfidenceBin& bin : confidence_bins) {
    difference += std::abs(bin.confidence - static_cast<double>(bin.correct));
    pixels += bin.pixels;
  }
  return pixels == 0 ? std::numeric_limits<double>::quiet_NaN() : difference / static_cast<double>(pixels);
}

double ClassEvaluation::iou() const { return ratio(both, true_pixels + found_pixels - both); }
double ClassEvaluation::accuracy() const { return ratio(both, true_pixels); }
double ClassEvaluation::detection_rate() const { return ratio(detected, images); }
double ClassEvaluation::boundary_iou() const { return ratio(boundary_both, boundary_union); }

double SegmentationEvaluation::overall_accuracy() const { return ratio(correct_pixels, known_pixels); }

double SegmentationEvaluation::mean_iou() const {
  double sum = 0.0;
  int count = 0;
  for (const ClassEvaluation& one : classes)
    if (one.true_pixels > 0) sum += one.iou(), ++count;
  return sum / count;
}

double SegmentationEvaluation::mean_accuracy() const {
  double sum = 0.0;
  int count = 0;
  for (const ClassEvaluation& one : classes)
    if (one.true_pixels > 0) sum += one.accuracy(), ++count;
  return sum / count;
}

SegmentationEvaluator::SegmentationEvaluator(std::vector<std::string> classes, const std::string& outlined) {
  outlined_ = static_cast<std::size_t>(std::find(classes.begin(), classes.end(), outlined) - classes.begin());
  for (std::string& name : classes) result_.classes.push_back({.name = std::move(name)});
}

void SegmentationEvaluator::add(const cv::Mat& labels, const cv::Mat& predictions, const cv::Mat& confidence) {
  HOLDFAST_CHECK(labels.type() == CV_8UC1 && predictions.type() == CV_8UC1 && labels.size() == predictions.size(),
                 "labels " << labels.type() << ' ' << labels.cols << 'x' << labels.rows << " predictions "
                           << predictions.type() << ' ' << predictions.cols << 'x' << predictions.rows);
  HOLDFAST_CHECK(confidence.empty() || (confidence.type() == CV_8UC1 && confidence.size() == labels.size()),
                 "confidence " << confidence.type() << ' ' << confidence.cols << 'x' << confidence.rows << " labels "
                               << labels.cols << 'x' << labels.rows);
  std::vector<std::uint64_t> pairs(256 * 256);
  for (int y = 0; y < labels.rows; ++y) {
    const auto* label = labels.ptr<std::uint8_t>(y);
    const auto* prediction = predictions.ptr<std::uint8_t>(y);
    for (int x = 0; x < labels.cols; ++x) ++pairs[std::size_t{256} * label[x] + prediction[x]];
  }
  const std::size_t count = result_.classes.size();
  ++result_.images;
  std::vector<ClassEvaluation> here(count);
  for (std::size_t label = 0; label < 256; ++label)
    for (std::size_t prediction = 0; prediction < 256; ++prediction) {
      const std::uint64_t pixels = pairs[256 * label + prediction];
      if (pixels == 0 || label == CellMask::unknown) continue;
      HOLDFAST_CHECK(label < count && (prediction < count || prediction == CellMask::unknown),
                     "label " << label << " prediction " << prediction << " classes " << count);
      result_.known_pixels += pixels;
      here[label].true_pixels += pixels;
      if (prediction != CellMask::unknown) here[prediction].found_pixels += pixels;
      if (prediction == label) here[label].both += pixels;
    }
  for (std::size_t label = 0; label < count; ++label) {
    ClassEvaluation& sum = result_.classes[label];
    const ClassEvaluation& image = here[label];
    sum.true_pixels += image.true_pixels;
    sum.found_pixels += image.found_pixels;
    sum.both += image.both;
    result_.correct_pixels += image.both;
    if (image.true_pixels == 0) continue;
    ++sum.images;
    sum.detected += image.iou() > detection_threshold;
  }
  if (!confidence.empty()) add_confidence(labels, predictions, confidence, result_.classes);
  if (outlined_ < count && here[outlined_].true_pixels + here[outlined_].found_pixels > 0)
    compare_outlines(labels, predictions, static_cast<std::uint8_t>(outlined_), result_.classes[outlined_]);
}

}  // namespace holdfast
