// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/size_text.hpp"
#include "holdfast/image_files/image_decoder.hpp"
#include "holdfast/image_files/label_map.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/precomputed.hpp"
#include "label_array.hpp"
#include "label_files.hpp"
#include "label_fit.hpp"

namespace holdfast {

void PrecomputedSettings::describe(ParameterTable<PrecomputedSettings>& table) {
  using S = PrecomputedSettings;
  table
      .add("path", &S::path,
           "folder of label images (PNG, 1 channel of 8 or 16 bits, or indices into a palette; or arrays of NumPy, "
           ".npy), or of "
           "one image for each instance")
      .required();
  table.add("list", &S::list,
            "file with lines 'timestamp filename', names relative to path; empty = the name of each PNG or NPY file in "
            "path is its time stamp, with an underscore and anything behind it for one of several instances");
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
    const LabelArray first = read(file->path, frame.colour.size());
    if (!file->is_of_instance && !first.is_of_instances) return {labels_.apply(first.images.front(), file->path), {}};
    Segmentation result{
        cv::Mat::zeros(frame.colour.size(), CV_8UC1), {}, cv::Mat::zeros(frame.colour.size(), CV_16UC1), {}};
    add_instances(first.images, file->path, result);
    for (const std::filesystem::path& other : file->others)
      add_instances(read(other, frame.colour.size()).images, other, result);
    return result;
  }

 private:
  /// The images of a file: one but for an array of instances.
  LabelArray read(const std::filesystem::path& file, const cv::Size& frame) {
    const auto check_size = [&](const cv::Size& size) {
      if (size != frame)
        throw InputError({file.string()},
                         "is " + size_text(size.width, size.height) + " pixels, but the frame is " +
                             size_text(frame.width, frame.height) +
                             "; expected labels of the frame's size; scale them without interpolation");
    };
    if (!is_array(file)) return {{decoder_.read_labels(file, check_size)}};
    LabelArray array = read_label_array(file);
    for (const cv::Mat& image : array.images) check_size(image.size());
    return array;
  }

  /// Adds the masks of instances, each of one class; a later one covers those before it.
  void add_instances(const std::vector<cv::Mat>& masks, const std::filesystem::path& file, Segmentation& result) const {
    for (const cv::Mat& values : masks) {
      const cv::Mat labels = labels_.apply(values, file);
      if (result.found.size() == 65535)
        throw InputError({file.string()}, "is of more than 65535 instances of a frame; expected fewer");
      const auto number = static_cast<std::uint16_t>(result.found.size() + 1);
      Instance instance{.label = 0, .score = 1.0F};
      cv::Rect box;
      for (int y = 0; y < labels.rows; ++y) {
        const auto* label = labels.ptr<std::uint8_t>(y);
        for (int x = 0; x < labels.cols; ++x) {
          if (label[x] == 0) continue;
          result.labels.at<std::uint8_t>(y, x) = label[x];
          result.instances.at<std::uint16_t>(y, x) = label[x] == CellMask::unknown ? 0 : number;
          if (label[x] == CellMask::unknown) continue;
          if (instance.label != 0 && instance.label != label[x])
            throw InputError({file.string()}, "is the mask of an instance and has the classes '" +
                                                  classes()[instance.label] + "' and '" + classes()[label[x]] +
                                                  "'; expected one class for each instance");
          instance.label = label[x];
          box |= cv::Rect(x, y, 1, 1);
        }
      }
      if (instance.label == 0) continue;
      instance.box = box;
      result.found.push_back(instance);
    }
  }

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
      {.name = PrecomputedSettings::module,
       .summary = "Reads label images and masks of instances from a folder by time stamp."});
}

}  // namespace holdfast
