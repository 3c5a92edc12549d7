// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "coco_masks.hpp"
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
           ".npy), or of one image for each instance; or a file of annotations in COCO's JSON, with polygons or run "
           "lengths, whose images have time stamps as names")
      .required();
  table.add("list", &S::list,
            "file with lines 'timestamp filename', names relative to path; empty = the name of each PNG or NPY file in "
            "path is its time stamp, with an underscore and anything behind it for one of several instances");
  table
      .add("tolerance", &S::tolerance,
           "maximum time difference between frame and label image; 0 = identical time stamps")
      .range(0.0, 3600.0)
      .unit("s");
  table.add(
      "labels", &S::labels,
      "class names of values or ranges, such as { 1-254: person, 255: unknown }; 0 is the background unless named; "
      "'unknown' is reserved for unlabelled pixels; required but for a file of COCO, of whose categories it names "
      "the numbers; empty = their names there");
}

namespace {

using namespace precomputed_plugin;

/// Stamps in file names and lists have six decimals.
constexpr double min_tolerance = 1e-6;

/// Label images that were made before.
class PrecomputedSegmenter final : public Segmenter {
 public:
  PrecomputedSegmenter(const PrecomputedSettings& settings, const CreationContext& context)
      : coco_(is_coco(settings) ? read_coco(settings.path) : CocoFile()),
        labels_(label_map(settings), "segmenter.precomputed.labels"),
        files_(label_files(settings)),
        tolerance_(std::max(settings.tolerance, min_tolerance)) {
    if (!context.frame_timestamps.empty())
      check_times(settings.list.empty() ? settings.path : settings.list, context.frame_timestamps);
  }

  Warnings warnings() const override { return warnings_; }
  const std::vector<std::string>& classes() const override { return labels_.classes(); }

  Segmentation segment(const SensorFrame& frame) override {
    const LabelFile* file = nearest_label_file(files_, frame.timestamp, tolerance_);
    if (file == nullptr) return {};
    if (!coco_.images.empty()) return objects_of(image_of(*file), frame.colour.size(), file->path);
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
  static bool is_coco(const PrecomputedSettings& settings) { return settings.path.extension() == ".json"; }

  TextMap label_map(const PrecomputedSettings& settings) const {
    if (is_coco(settings) && settings.labels.empty()) return coco_.categories;
    if (settings.labels.empty())
      throw ConfigurationError(SourceLocation{},
                               "segmenter.precomputed.labels: is missing; expected the class names of values, such as "
                               "{ 1-254: person }");
    return settings.labels;
  }

  std::vector<LabelFile> label_files(const PrecomputedSettings& settings) const {
    if (!is_coco(settings))
      return settings.list.empty() ? find_label_files(settings.path) : listed_label_files(settings.path, settings.list);
    if (!settings.list.empty())
      throw ConfigurationError(SourceLocation{},
                               "segmenter.precomputed.list: has no effect, because `path` is a file of COCO, which "
                               "names its images itself; leave it out");
    if (coco_.images.empty())
      throw InputError({settings.path.string()}, "has no image; expected annotations of the frames");
    std::vector<LabelFile> files;
    for (const CocoImage& image : coco_.images) files.push_back({image.timestamp, settings.path});
    return files;
  }

  const CocoImage& image_of(const LabelFile& file) const {
    return coco_.images[static_cast<std::size_t>(&file - files_.data())];
  }

  /// The objects of an image of COCO by decreasing score. A later one covers those before it, a better one all others.
  Segmentation objects_of(const CocoImage& image, const cv::Size& frame, const std::filesystem::path& file) const {
    if (image.size != frame)
      throw InputError({file.string()}, "has an image of " + size_text(image.size.width, image.size.height) +
                                            " pixels, but the frame is " + size_text(frame.width, frame.height) +
                                            "; expected annotations of the frame's size");
    std::vector<std::size_t> order(image.objects.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return image.objects[a].score < image.objects[b].score; });
    Segmentation result{cv::Mat::zeros(frame, CV_8UC1), {}, cv::Mat::zeros(frame, CV_16UC1), {}};
    for (const std::size_t i : order) {
      const CocoObject& object = image.objects[i];
      const cv::Mat mask = mask_of(object, frame);
      const cv::Rect box = cv::boundingRect(mask);
      const std::uint8_t label = label_of(object.category, file);
      if (box.empty() || label == CellMask::background) continue;
      result.labels.setTo(label, mask);
      const bool is_instance = !object.is_crowd && label != CellMask::unknown;
      if (is_instance) result.found.push_back({label, object.score, box});
      result.instances.setTo(is_instance ? static_cast<double>(result.found.size()) : 0.0, mask);
    }
    // The best first: numbers from the end.
    const auto count = static_cast<std::uint16_t>(result.found.size());
    std::reverse(result.found.begin(), result.found.end());
    for (int y = 0; y < frame.height; ++y)
      for (int x = 0; x < frame.width; ++x)
        if (std::uint16_t& number = result.instances.at<std::uint16_t>(y, x); number != 0)
          number = static_cast<std::uint16_t>(count + 1 - number);
    return result;
  }

  std::uint8_t label_of(int category, const std::filesystem::path& file) const {
    return labels_.apply(cv::Mat(1, 1, CV_16UC1, cv::Scalar(category)), file).at<std::uint8_t>(0, 0);
  }

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

  CocoFile coco_;  ///< empty for label images
  LabelMap labels_;
  std::vector<LabelFile> files_;  ///< or images of coco_, in their order
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
