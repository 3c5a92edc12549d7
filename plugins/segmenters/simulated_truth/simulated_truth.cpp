// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/truth.hpp"

namespace holdfast {

void TruthSettings::describe(ParameterTable<TruthSettings>& table) {
  table.add("classes", &TruthSettings::classes,
            "classes of the source to segment, all others are background; empty = all classes of the source");
  table.add("instances", &TruthSettings::instances,
            "also separate the objects that can move, such as several people, by the source's object mask");
}

namespace {

constexpr const char* remedy =
    "choose a segmenter that needs no truth: 'precomputed' for label images in a folder, 'onnx' for a network";

/// The exact classes that a simulated source knows.
class TruthSegmenter final : public Segmenter {
 public:
  TruthSegmenter(const TruthSettings& settings, const CreationContext& context) {
    std::vector<std::string> known = context.class_names;
    if (known.empty())
      throw ConfigurationError(SourceLocation{},
                               std::string("segmenter.truth: the source does not know the classes of its pixels, only "
                                           "a simulation does; ") +
                                   remedy);
    // The class that filters name, so that a room without people runs with the same configuration.
    if (known.size() < CellMask::unknown && std::find(known.begin(), known.end(), "person") == known.end())
      known.emplace_back("person");
    classes_.push_back(known.front());
    has_instances_ = settings.instances;
    std::vector<Diagnostic> diagnostics;
    for (const std::string& name : settings.classes)
      if (std::find(known.begin() + 1, known.end(), name) == known.end())
        diagnostics.push_back({{},
                               "segmenter.truth.classes: the source has no class '" + name + "'; " +
                                   did_you_mean(name, {known.begin() + 1, known.end()})});
    if (!diagnostics.empty()) throw ConfigurationError(std::move(diagnostics));
    label_of_.fill(CellMask::unknown);
    label_of_[0] = 0;
    for (std::size_t i = 1; i < std::min<std::size_t>(known.size(), CellMask::unknown); ++i) {
      const bool wanted = settings.classes.empty() || std::find(settings.classes.begin(), settings.classes.end(),
                                                                known[i]) != settings.classes.end();
      label_of_[i] = static_cast<std::uint8_t>(wanted ? classes_.size() : 0);
      if (wanted) classes_.push_back(known[i]);
    }
  }

  const std::vector<std::string>& classes() const override { return classes_; }

  Segmentation segment(const SensorFrame& frame) override {
    if (!frame.truth || frame.truth->class_labels.empty())
      throw InputError({}, "frame " + std::to_string(frame.index) +
                               " comes without the true classes of its pixels, which the segmenter 'truth' hands on; " +
                               remedy);
    const cv::Mat& truth = frame.truth->class_labels;
    Segmentation result{cv::Mat(truth.size(), CV_8UC1), {}};
    for (int y = 0; y < truth.rows; ++y)
      std::transform(truth.ptr<std::uint8_t>(y), truth.ptr<std::uint8_t>(y) + truth.cols,
                     result.labels.ptr<std::uint8_t>(y), [this](std::uint8_t value) { return label_of_[value]; });
    if (has_instances_) add_instances(frame, result);
    return result;
  }

 private:
  /// The objects of the source's mask that have a class, in the order of their numbers.
  void add_instances(const SensorFrame& frame, Segmentation& result) const {
    const cv::Mat& objects = frame.truth->object_mask;
    if (objects.size() != result.labels.size())
      throw InputError({}, "frame " + std::to_string(frame.index) +
                               " comes without the true objects of its pixels; expected them for `instances: true`");
    struct Extent {
      int left = 0, top = 0, right = -1, bottom = -1;
      std::uint8_t label = 0;
    };
    std::array<Extent, 256> extents;
    const auto is_object = [&](int y, int x) {
      return objects.at<std::uint8_t>(y, x) != 0 && CellMask::is_object(result.labels.at<std::uint8_t>(y, x));
    };
    for (int y = 0; y < objects.rows; ++y)
      for (int x = 0; x < objects.cols; ++x) {
        if (!is_object(y, x)) continue;
        Extent& extent = extents[objects.at<std::uint8_t>(y, x)];
        if (extent.right < 0) extent = {x, y, x, y, result.labels.at<std::uint8_t>(y, x)};
        extent.left = std::min(extent.left, x), extent.right = std::max(extent.right, x);
        extent.bottom = y;
      }
    std::array<std::uint16_t, 256> number{};
    for (std::size_t k = 1; k < extents.size(); ++k) {
      const Extent& extent = extents[k];
      if (extent.right < 0) continue;
      const cv::Rect box(extent.left, extent.top, extent.right - extent.left + 1, extent.bottom - extent.top + 1);
      result.found.push_back({extent.label, 1.0F, box});
      number[k] = static_cast<std::uint16_t>(result.found.size());
    }
    result.instances = cv::Mat::zeros(objects.size(), CV_16UC1);
    for (int y = 0; y < objects.rows; ++y)
      for (int x = 0; x < objects.cols; ++x)
        if (is_object(y, x)) result.instances.at<std::uint16_t>(y, x) = number[objects.at<std::uint8_t>(y, x)];
  }

  std::vector<std::string> classes_;
  bool has_instances_ = false;
  std::array<std::uint8_t, 256> label_of_{};  // by the source's label
};

}  // namespace

HOLDFAST_PLUGIN(simulated_truth, registry) {
  registry.add<Segmenter, TruthSegmenter, TruthSettings>(
      {.name = TruthSettings::module, .summary = "Exact class labels from a simulated source."});
}

}  // namespace holdfast
