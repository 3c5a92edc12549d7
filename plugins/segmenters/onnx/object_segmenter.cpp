// SPDX-License-Identifier: BSD-3-Clause
#include "object_segmenter.hpp"

#include <algorithm>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "holdfast/core/counted.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/inference/network_segmenter.hpp"
#include "holdfast/inference/object_masks.hpp"
#include "holdfast/inference/onnx_net.hpp"
#include "preset.hpp"

namespace holdfast::onnx_plugin {

namespace {

/// The options with the size of the input that the metadata says, where neither the settings nor the model say one.
NetworkOptions with_all_outputs(NetworkOptions options, const OnnxSignature& signature, const ModelMetadata& metadata) {
  options.every_output = true;
  const OnnxTensor& input = signature.inputs.front();
  if (input.shape.size() != 4) return options;
  const std::size_t row = options.channels_last ? 1 : 2;
  if (options.height == 0 && input.shape[row] == -1) options.height = metadata.height;
  if (options.width == 0 && input.shape[row + 1] == -1) options.width = metadata.width;
  return options;
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g", value);
  return text;
}

}  // namespace

ObjectSegmenter::ObjectSegmenter(const OnnxSettings& settings, const NetworkOptions& options,
                                 const OnnxSignature& signature, const ModelMetadata& metadata)
    : classes_(object_classes(settings, metadata)),
      network_(with_all_outputs(options, signature, metadata)),
      model_(settings.model) {
  SensorFrame trial;
  trial.colour = cv::Mat::zeros(network_.height(), network_.width(), CV_8UC3);
  network_.run(trial.colour);
  recognise(settings, metadata);
  prepare(settings);
  segment(trial);
}

void ObjectSegmenter::recognise(const OnnxSettings& settings, const ModelMetadata& metadata) {
  ObjectQuestion question{.outputs = network_.signature().outputs,
                          .input = input(),
                          .task = metadata.task,
                          .classes = classes_.count(),
                          .family = settings.family,
                          .wants_masks = settings.output != NetworkOutput::boxes,
                          .model = model_};
  for (std::size_t i = 0; i < question.outputs.size(); ++i) {
    const cv::Mat& output = network_.outputs()[i];
    question.outputs[i].shape.assign(output.size.p, output.size.p + output.dims);
  }
  layout_ = recognise_objects(question);
  const auto fail = [&](const std::string& message) { throw InputError({model_.string()}, message); };
  if (settings.output == NetworkOutput::instances && !layout_.prototypes && !layout_.masks)
    fail("gives " + names(question.outputs) + ", the boxes of " + layout_.preset.title +
         " without masks; expected prototypes, 1 x coefficients x height x width, for `output: instances`; set "
         "`output: boxes`, or choose another network");
  if (classes_.count() == 0)
    fail("has no class names in its metadata (`names`); name its " +
         (layout_.classes > 0 ? std::to_string(layout_.classes) + " classes" : std::string("classes")) +
         " in `classes`, without a background");
}

void ObjectSegmenter::prepare(const OnnxSettings& settings) {
  const OnnxSettings s = with_preset(settings, shipped_preset(choice_name(layout_.preset.family)));
  const auto or_else = [](const std::vector<double>& given, double otherwise) {
    return given.empty() ? std::vector<double>(3, otherwise) : given;
  };
  preparation_ = {s.fit == InputFit::letterbox, s.colour_order != ColourOrder::bgr, s.scale, or_else(s.mean, 0.0),
                  or_else(s.standard_deviation, 1.0)};
  network_.set_preparation(preparation_);
  min_score_ = s.min_score;
  // Class numbers are of a network that suppresses duplicates by itself.
  const bool is_suppressed = layout_.preset.scores == ScoreForm::numbered && settings.max_overlap == 0.0;
  max_overlap_ = is_suppressed ? 1.0 : s.max_overlap;
  colours_ = colour_text(s);
}

std::string ObjectSegmenter::description() const {
  const ObjectPreset& preset = layout_.preset;
  std::string text =
      model_.filename().string() + " is a network of the family " + choice_name(preset.family) + ", " + preset.title +
      ", that gives " +
      (layout_.prototypes || layout_.masks ? "instances with masks" : "boxes, which become masks by depth") +
      ". Input " + std::to_string(network_.width()) + "x" + std::to_string(network_.height()) +
      (preparation_.letterbox ? " with a letterbox, " : ", stretched, ") + colours_ + ". " +
      class_text({classes_.names.begin() + 1, classes_.names.end()}) +
      (classes_.are_of_metadata ? " named by its metadata" : "") + ", movable: ";
  for (const std::string& name : classes_.movable) text += (name == classes_.movable.front() ? "" : ", ") + name;
  if (classes_.movable.empty()) text += "not said";
  text += ". Scores of at least " + number_text(min_score_);
  text += max_overlap_ < 1.0 ? ", duplicates overlap by more than " + number_text(max_overlap_) + "."
                             : ", no suppression of duplicates.";
  text += " Computed by " + network_.engine_text() + ".";
  return text;
}

bool ObjectSegmenter::is_movable(std::size_t label) const {
  return std::find(classes_.movable.begin(), classes_.movable.end(), classes_.names[label]) != classes_.movable.end();
}

cv::Mat ObjectSegmenter::mask_of(const Detection& detection, const SensorFrame& frame, const FramePlace& place,
                                 const cv::Rect& pixels) const {
  const std::vector<cv::Mat>& outputs = network_.outputs();
  if (layout_.prototypes)
    return prototype_mask(outputs[*layout_.prototypes], detection.mask_coefficients, place, pixels);
  if (!layout_.masks) return depth_mask(frame.depth, pixels);
  const cv::Mat& masks = outputs[*layout_.masks];
  const int rows = masks.size[2], columns = masks.size[3];
  const std::ptrdiff_t first = std::ptrdiff_t{detection.number} * rows * columns;
  const cv::Mat image(rows, columns, CV_32F, const_cast<float*>(masks.ptr<float>()) + first);
  // Of a part that only its box has, or of all of the input.
  const bool is_of_box = layout_.has_boxes && (rows != network_.height() || columns != network_.width());
  const cv::Rect2f whole(0.0F, 0.0F, static_cast<float>(network_.width()), static_cast<float>(network_.height()));
  return image_mask(image, is_of_box ? detection.box : whole, layout_.preset.mask_threshold, place, pixels);
}

Segmentation ObjectSegmenter::segment(const SensorFrame& frame) {
  check_colour_image(frame);
  network_.run(frame.colour);
  const std::vector<cv::Mat>& outputs = network_.outputs();
  std::vector<Detection> detections = decode_objects(outputs, layout_, input(), min_score_, classes_.count(), model_);
  suppress_duplicates(detections, max_overlap_);
  const FramePlace place = place_of_frame(frame.colour.size(), input(), preparation_.letterbox);
  std::vector<ObjectMask> objects;
  for (const Detection& detection : detections) {
    const auto label = static_cast<std::size_t>(detection.class_number) + 1;
    ObjectMask object{{static_cast<std::uint8_t>(label), detection.score, place.box_in_frame(detection.box)}};
    object.pixels = pixels_of(object.instance.box, frame.colour.size());
    if (object.pixels.empty()) continue;
    object.mask = mask_of(detection, frame, place, object.pixels);
    if (!layout_.has_boxes) {
      const cv::Rect box = cv::boundingRect(object.mask);
      if (box.empty()) continue;
      object.mask = object.mask(box).clone();
      object.pixels = box + object.pixels.tl();
      object.instance.box = object.pixels;
    }
    object.is_movable = is_movable(label);
    objects.push_back(std::move(object));
  }
  return join_objects(objects, frame.colour.size());
}

}  // namespace holdfast::onnx_plugin
