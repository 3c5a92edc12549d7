// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/inference/network_parameters.hpp"
#include "holdfast/inference/network_segmenter.hpp"
#include "holdfast/inference/onnx_net.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/onnx.hpp"
#include "object_classes.hpp"
#include "object_segmenter.hpp"
#include "preset.hpp"

namespace holdfast {

void OnnxSettings::describe(ParameterTable<OnnxSettings>& table) {
  using S = OnnxSettings;
  table.add("model", &S::model, "network for semantic segmentation, instances or boxes, ONNX").required();
  table.add("preset", &S::preset,
            "values for parameters that have their defaults: a preset of the module, or a YAML file (.yaml) with such "
            "values, relative to the model's folder; empty = of the family");
  describe_network_input(table, "; empty = of the preset, otherwise 0", "; empty = of the preset, otherwise 1");
  table.add("fit", &S::fit,
            "how an image fills an input of another aspect ratio: stretched, or with a grey margin (letterbox); auto = "
            "as the family is trained; semantic networks stretch");
  table.add("layout", &S::layout, "layout of input and output: channels before or after height and width");
  table.add("output", &S::output,
            "output of the network: scores before softmax, probabilities, or class indices, where a single channel of "
            "logits or probabilities belongs to the second of two classes; instances (boxes, coefficients and "
            "prototypes), or boxes; auto = instances or boxes if metadata and outputs are those of a known family, "
            "otherwise logits");
  table.add("family", &S::family,
            "family of a network for instances or boxes, which says what its outputs mean and how it is used; auto = "
            "recognised by metadata and outputs");
  table.add("min_score", &S::min_score, "lowest score of an object; 0 = usual for the family").range(0, 1);
  table
      .add("max_overlap", &S::max_overlap,
           "intersection over union above which the lower of two boxes of a class is a duplicate; 0 = usual for the "
           "family, 1 = none is")
      .range(0, 1);
  table.add("output_name", &S::output_name, "name of the output, if a semantic network has several");
  table.add("classes", &S::classes,
            "class names by channel, label or class number; the first is the background if the network has one; "
            "'unknown' is reserved for unlabelled pixels; empty = those of the metadata of a network for objects, "
            "otherwise background and person");
  table.add("movable", &S::movable,
            "the subset of classes that can move; empty = person for a network for objects, otherwise not specified");
  describe_network_engine(table);
}

namespace {

using onnx_plugin::colour_text;
using onnx_plugin::ObjectSegmenter;

NetworkOptions options_of(const OnnxSettings& s) {
  NetworkOptions options = network_options(s);
  if (s.mean.empty()) options.mean = {0.0, 0.0, 0.0};
  if (s.standard_deviation.empty()) options.standard_deviation = {1.0, 1.0, 1.0};
  options.channels_last = s.layout == TensorLayout::nhwc;
  set_network_engine(options, s, false);
  return options;
}

std::string output_text(const OnnxSettings& s) {
  return choice_name(s.output == NetworkOutput::automatic ? NetworkOutput::logits : s.output);
}

OutputForm output_form(const OnnxSettings& s) {
  const OutputKind kind = s.output == NetworkOutput::labels          ? OutputKind::labels
                          : s.output == NetworkOutput::probabilities ? OutputKind::probabilities
                                                                     : OutputKind::logits;
  return {.kind = kind, .channels_last = s.layout == TensorLayout::nhwc, .model = s.model};
}

/// Throws ConfigurationError for parameters that have no meaning for this kind of network, all at once.
void refuse_parameters(const std::vector<std::pair<const char*, bool>>& set, const std::string& reason) {
  std::vector<Diagnostic> diagnostics;
  for (const auto& [name, is_set] : set)
    if (is_set)
      diagnostics.push_back({{}, std::string("segmenter.onnx.") + name + ": has no effect, because " + reason});
  if (!diagnostics.empty()) throw ConfigurationError(std::move(diagnostics));
}

/// A network for semantic segmentation: per-pixel classes.
class SemanticSegmenter final : public NetworkSegmenter {
 public:
  SemanticSegmenter(const OnnxSettings& settings, std::vector<std::string> classes)
      : NetworkSegmenter((check(settings, classes), options_of(settings)), output_form(settings), classes,
                         settings.movable),
        name_(settings.model.filename().string()),
        output_(output_text(settings)),
        colours_(colour_text(settings)) {}

  std::string description() const override {
    return name_ + " is a semantic network, output " + output_ + ". Input " + std::to_string(input_size().width) + "x" +
           std::to_string(input_size().height) + ", stretched, " + colours_ + ". " +
           onnx_plugin::class_text(classes()) + ". Computed by " + engine_text() + ".";
  }

 private:
  static void check(const OnnxSettings& s, const std::vector<std::string>& classes) {
    onnx_plugin::check_class_names(classes, s.movable, 2);
    refuse_parameters({{"family", s.family != ObjectFamily::automatic},
                       {"fit", s.fit == InputFit::letterbox},
                       {"min_score", s.min_score > 0.0},
                       {"max_overlap", s.max_overlap > 0.0}},
                      "the network is run as a semantic one (`output: " + output_text(s) +
                          "`), which has no objects; expected `output: instances` or `output: boxes`, or leave it out");
  }

  std::string name_, output_, colours_;
};

bool is_for_objects(const OnnxSettings& settings, const OnnxSignature& signature, const ModelMetadata& metadata) {
  if (settings.output != NetworkOutput::automatic)
    return settings.output == NetworkOutput::instances || settings.output == NetworkOutput::boxes;
  if (settings.family != ObjectFamily::automatic) return true;
  return settings.output_name.empty() && declares_objects(signature, metadata);
}

std::unique_ptr<Segmenter> make_segmenter(const OnnxSettings& settings) {
  if (!settings.classes.empty()) onnx_plugin::check_class_names(settings.classes, settings.movable, 1);
  const bool may_be_objects = settings.output != NetworkOutput::logits &&
                              settings.output != NetworkOutput::probabilities &&
                              settings.output != NetworkOutput::labels;
  if (may_be_objects) {
    const NetworkOptions options = options_of(settings);
    const OnnxSignature signature =
        OnnxNet({.model = settings.model, .engine = options.engine, .engine_library = options.engine_library})
            .signature();
    const ModelMetadata metadata = read_model_metadata(signature.metadata);
    if (is_for_objects(settings, signature, metadata)) {
      refuse_parameters({{"output_name", !settings.output_name.empty()}},
                        "all outputs of a network for objects are read; leave it out");
      return std::make_unique<ObjectSegmenter>(settings, options, signature, metadata);
    }
  }
  std::vector<std::string> classes = settings.classes;
  if (classes.empty()) classes = {"background", "person"};
  return std::make_unique<SemanticSegmenter>(settings, std::move(classes));
}

/// Any network that finds people or things in an image, as its file and the settings say.
class OnnxSegmenter final : public Segmenter {
 public:
  OnnxSegmenter(const OnnxSettings& settings, const CreationContext&)
      : segmenter_(make_segmenter(onnx_plugin::with_named_preset(settings))) {}

  const std::vector<std::string>& classes() const override { return segmenter_->classes(); }
  std::vector<std::string> movable() const override { return segmenter_->movable(); }
  std::string description() const override { return segmenter_->description(); }
  Segmentation segment(const SensorFrame& frame) override { return segmenter_->segment(frame); }

 private:
  std::unique_ptr<Segmenter> segmenter_;
};

}  // namespace

HOLDFAST_PLUGIN(onnx, registry) {
  registry.add<Segmenter, OnnxSegmenter, OnnxSettings>(
      {.name = OnnxSettings::module,
       .summary =
           "Runs networks for semantic segmentation, instances or boxes in ONNX format with ONNX Runtime, OpenCV "
           "or oneDNN."});
}

}  // namespace holdfast
