// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/instance_evaluation.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/check.hpp"
#include "holdfast/core/instance_overlaps.hpp"

namespace holdfast {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

double threshold(std::size_t index) { return 0.5 + 0.05 * static_cast<double>(index); }

/// Numbers of pixels of true (first) and found (second) instances.
InstanceOverlaps overlaps_of(const InstanceImage& truth, const InstanceImage& found, const cv::Mat& is_known) {
  InstanceOverlaps overlaps;
  for (int y = 0; y < truth.instances.rows; ++y)
    for (int x = 0; x < truth.instances.cols; ++x) {
      if (!is_known.empty() && is_known.at<std::uint8_t>(y, x) == 0) continue;
      const std::size_t t = truth.instances.at<std::uint16_t>(y, x), f = found.instances.at<std::uint16_t>(y, x);
      HOLDFAST_CHECK(t <= truth.entries.size() && f <= found.entries.size(), "instances " << t << " and " << f);
      overlaps.add(t, f);
    }
  return overlaps;
}

/// Precision at 101 recalls, of finds in the order of their scores.
double interpolated_precision(const std::vector<bool>& is_right, std::size_t true_instances) {
  std::vector<double> precision, recall;
  double right = 0.0;
  for (std::size_t i = 0; i < is_right.size(); ++i) {
    right += is_right[i] ? 1.0 : 0.0;
    precision.push_back(right / static_cast<double>(i + 1));
    recall.push_back(right / static_cast<double>(true_instances));
  }
  for (std::size_t i = precision.size(); i-- > 1;) precision[i - 1] = std::max(precision[i - 1], precision[i]);
  constexpr int steps = 100;
  double sum = 0.0;
  std::size_t at = 0;
  for (int step = 0; step <= steps; ++step) {
    while (at < recall.size() && recall[at] < step / static_cast<double>(steps) - 1e-12) ++at;
    sum += at < precision.size() ? precision[at] : 0.0;
  }
  return sum / (steps + 1);
}

template <class Figure>
double mean_over_classes(const InstanceEvaluation& evaluation, const Figure& figure) {
  double sum = 0.0;
  int count = 0;
  for (const ClassInstanceEvaluation& one : evaluation.classes)
    if (one.true_instances > 0) sum += figure(one), ++count;
  return count == 0 ? nothing : sum / count;
}

}  // namespace

double ClassInstanceEvaluation::ap() const {
  double sum = 0.0;
  for (const double precision : average_precision) sum += precision;
  return sum / static_cast<double>(average_precision.size());
}

double ClassInstanceEvaluation::panoptic_quality() const {
  const double unmatched = static_cast<double>(true_instances + found_instances - 2 * matched);
  const double whole = static_cast<double>(matched) + 0.5 * unmatched;
  return whole == 0.0 ? nothing : matched_iou / whole;
}

double InstanceEvaluation::mean_ap50() const {
  return mean_over_classes(*this, [](const ClassInstanceEvaluation& one) { return one.ap50(); });
}
double InstanceEvaluation::mean_ap() const {
  return mean_over_classes(*this, [](const ClassInstanceEvaluation& one) { return one.ap(); });
}
double InstanceEvaluation::mean_panoptic_quality() const {
  return mean_over_classes(*this, [](const ClassInstanceEvaluation& one) { return one.panoptic_quality(); });
}

InstanceEvaluator::InstanceEvaluator(std::vector<std::string> classes) : finds_(classes.size()) {
  for (std::string& name : classes) result_.classes.push_back({.name = std::move(name)});
}

void InstanceEvaluator::add(const InstanceImage& truth, const InstanceImage& found, const cv::Mat& is_known) {
  HOLDFAST_CHECK(truth.instances.type() == CV_16UC1 && found.instances.type() == CV_16UC1 &&
                     truth.instances.size() == found.instances.size(),
                 "types " << truth.instances.type() << " and " << found.instances.type());
  const InstanceOverlaps overlaps = overlaps_of(truth, found, is_known);
  const auto counts = [&](std::uint8_t label) {
    HOLDFAST_CHECK(label == CellMask::unknown || label < result_.classes.size(), "label " << int{label});
    return CellMask::is_object(label);
  };
  ++result_.images;
  for (std::size_t t = 1; t <= truth.entries.size(); ++t)
    if (counts(truth.entries[t - 1].label) && overlaps.of_first(t) > 0.0)
      ++result_.classes[truth.entries[t - 1].label].true_instances;
  std::vector<std::size_t> order;
  for (std::size_t f = 1; f <= found.entries.size(); ++f)
    if (counts(found.entries[f - 1].label)) order.push_back(f);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return found.entries[a - 1].score > found.entries[b - 1].score;
  });
  // The best first takes the true instance that it overlaps most, at each threshold on its own.
  std::array<std::vector<std::uint8_t>, instance_threshold_count> taken;
  for (auto& each : taken) each.assign(truth.entries.size() + 1, 0);
  for (const std::size_t f : order) {
    const std::uint8_t label = found.entries[f - 1].label;
    ClassInstanceEvaluation& one = result_.classes[label];
    ++one.found_instances;
    Find find{found.entries[f - 1].score, 0};
    for (std::size_t k = 0; k < instance_threshold_count; ++k) {
      std::size_t best = 0;
      double best_iou = threshold(k);
      for (std::size_t t = 1; t <= truth.entries.size(); ++t) {
        if (truth.entries[t - 1].label != label || taken[k][t] != 0) continue;
        if (const double iou = overlaps.iou(t, f); iou > best_iou || (best == 0 && iou >= best_iou && iou > 0.0))
          best = t, best_iou = iou;
      }
      if (best == 0) continue;
      taken[k][best] = 1;
      find.is_right = static_cast<std::uint16_t>(find.is_right | (1U << k));
      if (k == 0 && best_iou > 0.5) ++one.matched, one.matched_iou += best_iou;
    }
    finds_[label].push_back(find);
  }
}

InstanceEvaluation InstanceEvaluator::result() const {
  InstanceEvaluation result = result_;
  for (std::size_t label = 0; label < finds_.size(); ++label) {
    std::vector<Find> finds = finds_[label];
    std::stable_sort(finds.begin(), finds.end(), [](const Find& a, const Find& b) { return a.score > b.score; });
    ClassInstanceEvaluation& one = result.classes[label];
    for (std::size_t k = 0; k < instance_threshold_count; ++k) {
      std::vector<bool> is_right;
      for (const Find& find : finds) is_right.push_back((find.is_right >> k & 1U) != 0);
      one.average_precision[k] =
          one.true_instances == 0 ? nothing : interpolated_precision(is_right, one.true_instances);
    }
  }
  return result;
}

}  // namespace holdfast
