// SPDX-License-Identifier: BSD-3-Clause
#include "network_runner.hpp"

#include "holdfast/core/error.hpp"
#include "holdfast/inference/onnx_signature.hpp"

namespace holdfast {

std::string shapes_of(const NetworkRunner::Inputs& inputs) {
  std::string shapes;
  for (const auto& [name, input] : inputs)
    shapes +=
        (shapes.empty() ? "" : ", ") + shape_text(std::vector<std::int64_t>(input.size.p, input.size.p + input.dims));
  return shapes;
}

void require_engine(NetworkEngine engine, NetworkPrecision precision) {
  if (engine == NetworkEngine::onednn) return require_onednn(precision);
  if (precision != NetworkPrecision::fp32)
    throw ConfigurationError(SourceLocation{},
                             "precision: found bf16 with `engine: opencv`, which computes in fp32 only; expected fp32, "
                             "or `engine: onednn`");
}

}  // namespace holdfast
