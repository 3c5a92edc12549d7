// SPDX-License-Identifier: BSD-3-Clause
#include "network_runner.hpp"

#include "holdfast/core/error.hpp"
#include "holdfast/inference/network.hpp"
#include "holdfast/inference/onnx_signature.hpp"
#include "onnxruntime_library.hpp"

namespace holdfast {

std::string cannot_run(const std::string& engine, const OnnxNet::Use& use, const std::string& reason) {
  std::string shapes;
  for (const auto& [name, shape] : use.inputs) shapes += (shapes.empty() ? "" : ", ") + shape_text(shape);
  return "cannot be run by " + engine + " on an input of " + shapes + " (" + reason + "); " + use.advice;
}

void require_engine(const OnnxNet::File& file) {
  if (file.engine == NetworkEngine::onednn) return require_onednn(file.precision);
  const bool is_onnxruntime = file.engine == NetworkEngine::onnxruntime;
  if (file.precision != NetworkPrecision::fp32)
    throw ConfigurationError(SourceLocation{}, "precision: found bf16 with `engine: " +
                                                   std::string(choice_name(file.engine)) + "`, which computes " +
                                                   (is_onnxruntime ? "with the numbers of the file" : "in fp32 only") +
                                                   "; expected fp32, or `engine: onednn`");
  if (is_onnxruntime) OnnxruntimeLibrary::get(file.engine_library).require_provider(file.provider);
}

NetworkEngine chosen_engine(const EngineChoice& choice, bool is_for_onednn) {
  const bool wants_onnxruntime = choice.provider != "cpu" || !choice.engine_library.empty();
  if (choice.engine == NetworkEngine::automatic) {
    if (wants_onnxruntime) return NetworkEngine::onnxruntime;
    if (is_for_onednn && has_onednn()) return NetworkEngine::onednn;
    return has_onnxruntime() ? NetworkEngine::onnxruntime : NetworkEngine::opencv;
  }
  if (choice.engine != NetworkEngine::onnxruntime && wants_onnxruntime)
    throw ConfigurationError(SourceLocation{},
                             std::string(choice.provider != "cpu" ? "provider" : "engine_library") + ": found '" +
                                 (choice.provider != "cpu" ? choice.provider : choice.engine_library.string()) +
                                 "' with `engine: " + choice_name(choice.engine) +
                                 "`, which has no such choice; expected `engine: onnxruntime`, or leave it out");
  return choice.engine;
}

}  // namespace holdfast
