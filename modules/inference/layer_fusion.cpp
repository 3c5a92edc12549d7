// SPDX-License-Identifier: BSD-3-Clause
#include "layer_fusion.hpp"

#include <algorithm>
#include <utility>

namespace holdfast {

namespace {

bool is_convolution(const PlannedLayer& layer) {
  return layer.kind == LayerKind::convolution || layer.kind == LayerKind::transposed_convolution;
}

}  // namespace

void join_layers(NetworkPlan& plan) {
  std::vector<int> readers(plan.tensors.size(), 0);
  std::vector<std::optional<std::size_t>> writer(plan.tensors.size());
  for (const PlannedLayer& layer : plan.layers)
    for (const std::size_t input : layer.inputs) ++readers[input];
  for (const std::size_t output : plan.outputs) ++readers[output];

  std::vector<bool> is_joined(plan.layers.size(), false);
  const auto can_join = [&](std::size_t tensor) {
    return readers[tensor] == 1 && writer[tensor] && is_convolution(plan.layers[*writer[tensor]]) &&
           plan.layers[*writer[tensor]].activation == Activation::none;
  };
  for (std::size_t i = 0; i < plan.layers.size(); ++i) {
    PlannedLayer& layer = plan.layers[i];
    std::optional<std::size_t> joined, added;
    if (layer.kind == LayerKind::activation && can_join(layer.inputs[0])) joined = writer[layer.inputs[0]];
    if (layer.kind == LayerKind::add && layer.inputs[0] != layer.inputs[1]) {
      for (std::size_t side = 0; side < 2; ++side) {
        const std::size_t tensor = layer.inputs[side];
        if (!can_join(tensor) || plan.layers[*writer[tensor]].added) continue;
        if (joined && *joined > *writer[tensor]) continue;  // the later one: the other result is there by then
        joined = writer[tensor];
        added = layer.inputs[1 - side];
      }
    }
    if (joined) {
      PlannedLayer convolution = std::move(plan.layers[*joined]);
      is_joined[*joined] = true;
      convolution.output = layer.output;
      convolution.name += " with " + layer.name;
      if (added) convolution.added = added;
      convolution.activation = layer.activation;
      convolution.first_parameter = layer.first_parameter;
      convolution.second_parameter = layer.second_parameter;
      layer = std::move(convolution);
    }
    writer[layer.output] = i;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < plan.layers.size(); ++i)
    if (!is_joined[i] && i != kept++) plan.layers[kept - 1] = std::move(plan.layers[i]);
  plan.layers.resize(kept);
}

}  // namespace holdfast
