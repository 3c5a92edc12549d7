// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/core/counted.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/inference/network_parameters.hpp"
#include "holdfast/inference/network_segmenter.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/onnx.hpp"

namespace holdfast {

void OnnxSettings::describe(ParameterTable<OnnxSettings>& table) {
  using S = OnnxSettings;
  table.add("model", &S::model, "network for semantic segmentation, ONNX, float32").required();
  describe_network_input(table);
  table.add("layout", &S::layout, "layout of input and output: channels before or after height and width");
  table.add("output", &S::output,
            "output of the network: scores before softmax, probabilities, or class indices; a single channel of logits "
            "or probabilities belongs to the second of two classes");
  table.add("output_name", &S::output_name, "name of the output, if the model has several");
  table.add(
      "classes", &S::classes,
      "class names by channel or label; the first is the background if the network has one; 'unknown' is reserved "
      "for unlabelled pixels");
  table.add("movable", &S::movable, "the subset of classes that can move; empty = not specified");
  describe_network_engine(table);
}

namespace {

NetworkOptions options_of(const OnnxSettings& s) {
  NetworkOptions options = network_options(s);
  options.channels_last = s.layout == TensorLayout::nhwc;
  options.engine = s.engine == NetworkEngine::automatic ? NetworkEngine::opencv : s.engine;
  options.precision = s.precision;
  options.threads = s.threads;
  return options;
}

OutputForm output_form(const OnnxSettings& s) {
  const OutputKind kind = s.output == NetworkOutput::labels          ? OutputKind::labels
                          : s.output == NetworkOutput::probabilities ? OutputKind::probabilities
                                                                     : OutputKind::logits;
  return {.kind = kind, .channels_last = s.layout == TensorLayout::nhwc, .model = s.model};
}

/// Checked before the model is loaded, all at once.
void check_classes(const OnnxSettings& settings) {
  std::vector<Diagnostic> diagnostics;
  const auto problem = [&](const std::string& message) { diagnostics.push_back({{}, "segmenter.onnx." + message}); };
  if (settings.classes.size() < 2 || settings.classes.size() > 254)
    problem("classes: found " + counted(settings.classes.size(), "name") + "; expected 2 to 254");
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
class OnnxSegmenter final : public NetworkSegmenter {
 public:
  OnnxSegmenter(const OnnxSettings& settings, const CreationContext&)
      : NetworkSegmenter((check_classes(settings), options_of(settings)), output_form(settings), settings.classes,
                         settings.movable) {}
};

}  // namespace

HOLDFAST_PLUGIN(onnx, registry) {
  registry.add<Segmenter, OnnxSegmenter, OnnxSettings>(
      {.name = OnnxSettings::module,
       .summary = "Runs any semantic segmentation network in ONNX format on the CPU with OpenCV or oneDNN."});
}

}  // namespace holdfast
