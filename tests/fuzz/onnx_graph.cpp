// SPDX-License-Identifier: BSD-3-Clause
// The layers of an ONNX file, as the engine onednn reads and plans them.
#include "fuzz.hpp"
#include "network_plan.hpp"

using namespace holdfast;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::accepts([&] {
    const OnnxGraph graph = read_onnx_graph({data, size}, "network.onnx");
    std::map<std::string, std::vector<std::int64_t>> shapes;
    for (const OnnxTensor& input : graph.signature.inputs) {
      shapes[input.name] = input.shape;
      for (std::int64_t& side : shapes[input.name])
        if (side < 0) side = 32;
    }
    const NetworkPlan plan = plan_network(graph, shapes, {graph.signature.outputs.front().name}, "network.onnx");
    fuzz::require(plan.outputs.size() == 1, "the output is planned");
    for (const PlannedLayer& layer : plan.layers) {
      fuzz::require(!layer.inputs.empty() && layer.output < plan.tensors.size(), "layers have inputs and an output");
      for (const std::size_t input : layer.inputs) fuzz::require(input < plan.tensors.size(), "inputs are tensors");
    }
  });
  return 0;
}
