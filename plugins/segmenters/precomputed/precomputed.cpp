// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/core/size_text.hpp"
#include "holdfast/image_files/image_decoder.hpp"
#include "holdfast/image_files/label_map.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/precomputed.hpp"
#include "label_files.hpp"
#include "label_fit.hpp"

namespace holdfast {

void PrecomputedSettings::describe(ParameterTable<PrecomputedSettings>& table) {
  using S = PrecomputedSettings;
  table.add("path", &S::path, "folder of label images (PNG, 1 channel of 8 or 16 bits, or indices into a palette)")
      .required();
  table.add("list", &S::list,
            "file with lines 'timestamp filename', names relative to path; empty = the name of each PNG in path is "
            "its time stamp");
  table
      .add("tolerance", &S::tolerance,
           "maximum time difference between frame and label image; 0 = identical time stamps")
      .range(0.0, 3600.0)
      .unit("s");
  table
      .add(
          "labels", &S::labels,
          "class names of values or ranges, such as { 1-254: person, 255: unknown }; 0 is the background unless named; "
          "'unknown' is reserved for unlabelled pixels")
      .required();
}

namespace {

using namespace precomputed_plugin;

/// Stamps in file names and lists have six decimals.
constexpr double min_tolerance = 1e-6;

/// Label images that were made before.
class PrecomputedSegmenter final : public Segmenter {
 public:
  PrecomputedSegmenter(const PrecomputedSettings& settings, const CreationContext& context)
      : labels_(settings.labels, "segmenter.precomputed.labels"),
        files_(settings.list.empty() ? find_label_files(settings.path)
                                     : listed_label_files(settings.path, settings.list)),
        tolerance_(std::max(settings.tolerance, min_tolerance)) {
    if (!context.frame_timestamps.empty())
      check_times(settings.list.empty() ? settings.path : settings.list, context.frame_timestamps);
  }

  Warnings warnings() const override { return warnings_; }
  const std::vector<std::string>& classes() const override { return labels_.classes(); }

  Segmentation segment(const SensorFrame& frame) override {
    const LabelFile* file = nearest_label_file(files_, frame.timestamp, tolerance_);
    if (file == nullptr) return {};
    const cv::Mat values = decoder_.read_labels(file->path, [&](const cv::Size& size) {
      if (size != frame.colour.size())
        throw InputError({file->path.string()},
                         "is " + size_text(size.width, size.height) + " pixels, but the frame is " +
                             size_text(frame.colour.cols, frame.colour.rows) +
                             "; expected labels of the frame's size; scale them without interpolation");
    });
    return {labels_.apply(values, file->path), {}};
  }

 private:
  /// Throws InputError if no frame has a label image, and warns if few have, or if there are few frames, which may lie
  /// between two label images.
  void check_times(const std::filesystem::path& place, const std::vector<double>& frames) {
    const LabelFit fit = fit_labels(files_, frames, tolerance_);
    constexpr std::size_t few_frames = 10;
    if (fit.found == 0 && fit.frames >= few_frames)
      throw InputError({place.string()}, fit.found_text + ": " + fit.advice);
    if (2 * fit.found < fit.frames || fit.shift != 0.0)
      add_warning(
          warnings_,
          {{place.string()}, (fit.shift != 0.0 || fit.found == 0 ? "" : "only ") + fit.found_text + "; " + fit.advice});
  }

  LabelMap labels_;
  std::vector<LabelFile> files_;
  double tolerance_;
  Warnings warnings_;
  ImageDecoder decoder_;
};

}  // namespace

HOLDFAST_PLUGIN(precomputed, registry) {
  registry.add<Segmenter, PrecomputedSegmenter, PrecomputedSettings>(
      {.name = PrecomputedSettings::module, .summary = "Reads label images from a folder by time stamp."});
}

}  // namespace holdfast
