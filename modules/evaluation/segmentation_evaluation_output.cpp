// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <nlohmann/json.hpp>

#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/evaluation/segmentation_evaluation.hpp"

namespace holdfast {

namespace {

std::string right(const std::string& text, std::size_t width) {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}
std::string left(const std::string& text, std::size_t width) {
  return text.size() < width ? text + std::string(width - text.size(), ' ') : text;
}
std::string percent(double share) { return std::isnan(share) ? "-" : fixed_text(100.0 * share, 2); }

/// A row of a table: a name and figures.
std::string row(const std::string& name, std::initializer_list<std::string> cells) {
  constexpr std::size_t name_width = 16, width = 14;
  std::string line = left(name, name_width);
  for (const std::string& cell : cells) line += right(cell, width);
  return line + '\n';
}

using Json = nlohmann::ordered_json;

/// Reliability diagram of a class; intervals without pixels are left out.
Json reliability(const ClassEvaluation& one) {
  Json bins = Json::array();
  for (std::size_t i = 0; i < one.confidence_bins.size(); ++i) {
    const ConfidenceBin& bin = one.confidence_bins[i];
    if (bin.pixels == 0) continue;
    const auto pixels = static_cast<double>(bin.pixels);
    bins.push_back({{"from", static_cast<double>(i) / confidence_bin_count},
                    {"pixels", bin.pixels},
                    {"confidence", bin.confidence / pixels},
                    {"correct", static_cast<double>(bin.correct) / pixels}});
  }
  return bins;
}

Json instances_json(const InstanceEvaluation& evaluation) {
  Json classes = Json::array();
  for (const ClassInstanceEvaluation& one : evaluation.classes)
    if (one.true_instances + one.found_instances > 0)
      classes.push_back({{"name", one.name},
                         {"ap50", one.ap50()},
                         {"ap", one.ap()},
                         {"panoptic_quality", one.panoptic_quality()},
                         {"true_instances", one.true_instances},
                         {"found_instances", one.found_instances},
                         {"matched", one.matched}});
  return {{"images", evaluation.images},
          {"mean_ap50", evaluation.mean_ap50()},
          {"mean_ap", evaluation.mean_ap()},
          {"mean_panoptic_quality", evaluation.mean_panoptic_quality()},
          {"classes", classes}};
}

}  // namespace

std::string to_text(const SegmentationEvaluation& evaluation) {
  std::string text = row("", {"IoU [%]", "accuracy [%]", "detected [%]", "boundary [%]", "calibr. [%]", "false [%]",
                              "images", "pixels [%]"});
  const auto known = static_cast<double>(evaluation.known_pixels);
  for (const ClassEvaluation& one : evaluation.classes)
    text += row(one.name, {percent(one.iou()), percent(one.accuracy()), percent(one.detection_rate()),
                           percent(one.boundary_iou()), percent(one.calibration_error()),
                           percent(static_cast<double>(one.false_pixels()) / known), std::to_string(one.images),
                           percent(static_cast<double>(one.true_pixels) / known)});
  text += row("mean", {percent(evaluation.mean_iou()), percent(evaluation.mean_accuracy())});
  text += row("all pixels", {"", percent(evaluation.overall_accuracy())});
  return text + std::to_string(evaluation.images) + " images, " + std::to_string(evaluation.known_pixels) +
         " pixels with a true label. detected: images that show the class where its IoU is above 0.5.\n"
         "false: pixels found to be of the class that are not, of all. "
         "calibr.: mean difference between confidence and share of correct pixels.\n";
}

std::string to_text(const InstanceEvaluation& evaluation) {
  std::string text = row("instances", {"AP50 [%]", "AP [%]", "PQ [%]", "true", "found"});
  for (const ClassInstanceEvaluation& one : evaluation.classes)
    if (one.true_instances + one.found_instances > 0)
      text += row(one.name, {percent(one.ap50()), percent(one.ap()), percent(one.panoptic_quality()),
                             std::to_string(one.true_instances), std::to_string(one.found_instances)});
  return text + row("mean", {percent(evaluation.mean_ap50()), percent(evaluation.mean_ap()),
                             percent(evaluation.mean_panoptic_quality())});
}

std::string to_json(const SegmentationEvaluation& evaluation, const std::optional<InstanceEvaluation>& instances) {
  Json classes = Json::array();
  for (const ClassEvaluation& one : evaluation.classes)
    classes.push_back({{"name", one.name},
                       {"iou", one.iou()},
                       {"accuracy", one.accuracy()},
                       {"detection_rate", one.detection_rate()},
                       {"boundary_iou", one.boundary_iou()},
                       {"true_pixels", one.true_pixels},
                       {"found_pixels", one.found_pixels},
                       {"correct_pixels", one.both},
                       {"images", one.images},
                       {"detected_images", one.detected},
                       {"calibration_error", one.calibration_error()},
                       {"reliability", reliability(one)}});
  Json json = {{"images", evaluation.images},
               {"known_pixels", evaluation.known_pixels},
               {"correct_pixels", evaluation.correct_pixels},
               {"overall_accuracy", evaluation.overall_accuracy()},
               {"mean_iou", evaluation.mean_iou()},
               {"mean_accuracy", evaluation.mean_accuracy()},
               {"classes", classes}};
  if (instances) json["instances"] = instances_json(*instances);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace holdfast
