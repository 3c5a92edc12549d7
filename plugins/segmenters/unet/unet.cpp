// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/inference/network_parameters.hpp"
#include "holdfast/inference/network_segmenter.hpp"
#include "holdfast/inference/uncertain_regions.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/unet.hpp"
#include "second_look.hpp"
#include "shipped_weights.hpp"

namespace holdfast {

void UnetSettings::describe(ParameterTable<UnetSettings>& table) {
  using S = UnetSettings;
  table.add("size", &S::size,
            "size of the network input: small (224x192) takes half the time of base (384x288), which is more accurate; "
            "large (512x384) takes twice the time and finds more people who are far away");
  table.add("width", &S::width, "width of the network input, a multiple of 32; 0 = given by size")
      .range(0, 4096)
      .unit("px");
  table.add("height", &S::height, "height of the network input, a multiple of 32; 0 = given by size")
      .range(0, 4096)
      .unit("px");
  table.add("mirror", &S::mirror,
            "average the scores of the image and its mirror image: slightly more accurate, twice the time");
  table.add("second_look", &S::second_look,
            "look again, closer, at the part of the image in which the network is least certain: finds more people who "
            "are far away; up to twice the time");
  table
      .add("region_confidence", &S::region_confidence,
           "people are a region of the image only where the confidence of at least one pixel is as large: fewer things "
           "are taken for people, and some people are missed; 0 = everywhere")
      .range(0.0, 1.0);
  table.add("model", &S::model,
            "other weights in ONNX format, as written by training/export.py; empty = the built-in weights");
  describe_network_engine(table);
}

namespace {

using namespace unet_plugin;

/// The shipped network halves its picture five times.
void check_side(const char* name, int pixels) {
  constexpr int unit = 32;
  if (pixels % unit == 0) return;
  const int below = pixels / unit * unit;
  throw ConfigurationError({}, "segmenter.unet." + std::string(name) + " is " + std::to_string(pixels) +
                                   "; expected a multiple of " + std::to_string(unit) + ", such as " +
                                   (below > 0 ? std::to_string(below) + " or " : "") + std::to_string(below + unit));
}

/// How the shipped network looks at a picture of this size.
struct Look {
  int width, height;  ///< [px]
};

Look look_of(const UnetSettings& settings) {
  switch (settings.size) {
    case UnetSize::small:
      return {224, 192};
    case UnetSize::base:
      break;
    case UnetSize::large:
      return {512, 384};
  }
  return {384, 288};
}

NetworkOptions network_options(const UnetSettings& settings) {
  NetworkOptions options;
  options.width = settings.width > 0 ? settings.width : look_of(settings).width;
  options.height = settings.height > 0 ? settings.height : look_of(settings).height;
  // What training/samples.py does to a pixel.
  options.mean = {0.5, 0.5, 0.5};
  options.standard_deviation = {0.25, 0.25, 0.25};
  set_network_engine(options, settings, settings.model.empty());
  options.model = settings.model;
  if (settings.model.empty()) {
    check_side("width", options.width);
    check_side("height", options.height);
    options.model = "unet.onnx";
    options.bytes = shipped_unet();
    // Nothing can be wrong with them at the sizes that they were made for.
    options.in_background = settings.width == 0 && settings.height == 0;
  }
  return options;
}

/// Our U-Net, trained on photographs of people and on people in rooms.
class UnetSegmenter final : public NetworkSegmenter {
 public:
  UnetSegmenter(const UnetSettings& settings, const CreationContext&)
      : NetworkSegmenter(network_options(settings), {.model = network_options(settings).model},
                         {"background", "person", "chair", "table", "tv"}, {"person"}),
        mirror_(settings.mirror),
        second_look_(settings.second_look),
        region_confidence_(static_cast<std::uint8_t>(std::lround(255.0 * settings.region_confidence))) {}

  Segmentation segment(const SensorFrame& frame) override {
    Segmentation result = NetworkSegmenter::segment(frame);
    if (region_confidence_ > 0) drop_uncertain_regions(result, person, region_confidence_);
    return result;
  }

 protected:
  cv::Mat scores(const cv::Mat& colour) override {
    const cv::Mat first = look(colour);
    if (!second_look_ || !has_form_of_ours(first)) return first;
    const std::optional<cv::Rect> window = closer_.begin(first, colour.size(), input_size(), person);
    return window ? closer_.combine(look(colour(*window))) : first;
  }

 private:
  /// Other outputs, which `model` may bring, are for decode_segmentation() to refuse.
  bool has_form_of_ours(const cv::Mat& scores) const {
    return scores.dims >= 3 && scores.size[scores.dims - 3] == static_cast<int>(classes().size()) &&
           scores.isContinuous() && scores.type() == CV_32F;
  }

  cv::Mat look(const cv::Mat& colour) {
    if (!mirror_) return NetworkSegmenter::scores(colour);
    NetworkSegmenter::scores(colour).copyTo(mean_);
    auto* to = mean_.ptr<float>();
    const cv::Mat other = mirrored_scores();
    const auto width = static_cast<std::size_t>(other.size[other.dims - 1]);
    const auto* from = other.ptr<float>();
    for (std::size_t row = 0; row < other.total(); row += width)
      for (std::size_t x = 0; x < width; ++x) to[row + x] = 0.5F * (to[row + x] + from[row + width - 1 - x]);
    return mean_;
  }

  static constexpr std::uint8_t person = 1;  // index of the class
  bool mirror_, second_look_;
  std::uint8_t region_confidence_;
  cv::Mat mean_;
  SecondLook closer_;
};

}  // namespace

HOLDFAST_PLUGIN(unet, registry) {
  registry.add<Segmenter, UnetSegmenter, UnetSettings>(
      {.name = UnetSettings::module,
       .summary = "Segments people with the built-in U-Net; needs no files.",
       .paper = "Ronneberger et al., U-Net, MICCAI 2015"});
}

}  // namespace holdfast
