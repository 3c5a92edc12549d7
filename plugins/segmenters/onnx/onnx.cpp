// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/inference/network.hpp"
#include "holdfast/inference/segmentation_output.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace holdfast {

namespace {

struct OnnxSettings {
  std::filesystem::path model;
  int width = 0;
  int height = 0;
  std::string colour_order = "rgb";
  double scale = 1.0 / 255.0;
  std::vector<double> mean = {0.0, 0.0, 0.0};
  std::vector<double> standard_deviation = {1.0, 1.0, 1.0};
  std::string layout = "nchw";
  std::string output = "logits";
  std::string output_name;
  std::vector<std::string> classes = {"background", "person"};
  std::vector<std::string> movable;
  int threads = 0;

  static void describe(ParameterTable<OnnxSettings>& table) {
    using S = OnnxSettings;
    table.add("model", &S::model, "network for semantic segmentation, ONNX, float32").required();
    table.add("width", &S::width, "of the network's input; 0 = as the model declares it").range(0, 8192).unit("px");
    table.add("height", &S::height, "of the network's input; 0 = as the model declares it").range(0, 8192).unit("px");
    table.add("colour_order", &S::colour_order, "order of the input's channels").one_of({"rgb", "bgr"});
    table.add("scale", &S::scale, "input = (pixel * scale - mean) / standard_deviation, pixels from 0 to 255");
    table.add("mean", &S::mean, "subtracted from each channel, in colour_order, after scale");
    table.add("standard_deviation", &S::standard_deviation, "each channel is divided by it");
    table.add("layout", &S::layout, "of input and output: channels before or after height and width")
        .one_of({"nchw", "nhwc"});
    table
        .add("output", &S::output,
             "what the network gives: scores before softmax, probabilities, or the index of the class; one channel of "
             "logits or probabilities is the second of two classes")
        .one_of({"logits", "probabilities", "labels"});
    table.add("output_name", &S::output_name, "which output, where the model has several");
    table.add("classes", &S::classes,
              "names by channel or label; the first is the background where the network has one; 'unknown' is reserved "
              "for pixels that nobody is sure of");
    table.add("movable", &S::movable, "those of the classes that can move; empty = the filter decides");
    table
        .add("threads", &S::threads,
             "of OpenCV, for the whole process, because OpenCV knows no other; 0 = as it is (holdfast: 1)")
        .range(0, 256);
  }
};

NetworkOptions network_options(const OnnxSettings& s) {
  return {s.model,
          s.width,
          s.height,
          s.colour_order == "rgb",
          s.scale,
          s.mean,
          s.standard_deviation,
          s.layout == "nhwc",
          s.output_name,
          s.threads};
}

OutputForm output_form(const OnnxSettings& s) {
  const OutputKind kind = s.output == "labels"          ? OutputKind::labels
                          : s.output == "probabilities" ? OutputKind::probabilities
                                                        : OutputKind::logits;
  return {kind, s.layout == "nhwc", static_cast<int>(s.classes.size()), s.model};
}

/// Checked before the model is loaded, all at once.
void check_classes(const OnnxSettings& settings) {
  std::vector<Diagnostic> diagnostics;
  const auto problem = [&](const std::string& message) { diagnostics.push_back({{}, "segmenter.onnx." + message}); };
  if (settings.classes.size() < 2 || settings.classes.size() > 254)
    problem("classes: found " + std::to_string(settings.classes.size()) + " names; expected 2 to 254");
  for (auto name = settings.classes.begin(); name != settings.classes.end(); ++name) {
    if (name->empty()) problem("classes: a name is empty");
    if (std::find(settings.classes.begin(), name, *name) != name)
      problem("classes: '" + *name + "' stands there twice; expected different names");
  }
  for (const std::string& name : settings.movable)
    if (std::find(settings.classes.begin(), settings.classes.end(), name) == settings.classes.end())
      problem("movable: '" + name + "' is none of the classes; " + did_you_mean(name, settings.classes));
  if (!diagnostics.empty()) throw ConfigurationError(std::move(diagnostics));
}

/// Any network for semantic segmentation.
class OnnxSegmenter final : public Segmenter {
 public:
  OnnxSegmenter(const OnnxSettings& settings, const CreationContext&)
      : settings_((check_classes(settings), settings)),
        form_(output_form(settings)),
        network_(network_options(settings)) {
    const auto unknown = std::find(settings_.classes.begin(), settings_.classes.end(), "unknown");
    if (unknown != settings_.classes.end()) unknown_label_ = static_cast<int>(unknown - settings_.classes.begin());
    // Whatever does not fit shows now, before the first frame.
    SensorFrame trial;
    trial.colour = cv::Mat::zeros(network_.height(), network_.width(), CV_8UC3);
    segment(trial);
  }

  const std::vector<std::string>& classes() const override { return settings_.classes; }
  std::vector<std::string> movable() const override { return settings_.movable; }

  Segmentation segment(const SensorFrame& frame) override {
    Segmentation result = decode_segmentation(network_.run(frame.colour), form_, frame.colour.cols, frame.colour.rows);
    if (unknown_label_ >= 0) result.labels.setTo(255, result.labels == unknown_label_);
    return result;
  }

 private:
  OnnxSettings settings_;
  OutputForm form_;
  Network network_;
  int unknown_label_ = -1;
};

}  // namespace

HOLDFAST_PLUGIN(onnx, registry) {
  registry.add<Segmenter, OnnxSegmenter, OnnxSettings>(
      {.name = "onnx", .summary = "Any network for semantic segmentation in ONNX format, on the CPU through OpenCV."});
}

}  // namespace holdfast
