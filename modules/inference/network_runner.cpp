// SPDX-License-Identifier: BSD-3-Clause
#include "network_runner.hpp"

#include "holdfast/core/error.hpp"
#include "holdfast/inference/onnx_signature.hpp"

namespace holdfast {

std::string cannot_run(const std::string& engine, const OnnxNet::Use& use, const std::string& reason) {
  std::string shapes;
  for (const auto& [name, shape] : use.inputs) shapes += (shapes.empty() ? "" : ", ") + shape_text(shape);
  return "cannot be run by " + engine + " on an input of " + shapes + " (" + reason + "); " + use.advice;
}

void require_engine(NetworkEngine engine, NetworkPrecision precision) {
  if (engine == NetworkEngine::onednn) return require_onednn(precision);
  if (precision != NetworkPrecision::fp32)
    throw ConfigurationError(SourceLocation{},
                             "precision: found bf16 with `engine: opencv`, which computes in fp32 only; expected fp32, "
                             "or `engine: onednn`");
}

}  // namespace holdfast
