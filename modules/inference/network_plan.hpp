// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "onnx_graph.hpp"

namespace holdfast {

/// Images, channels, height, width.
using PlaneShape = std::array<std::int64_t, 4>;

enum class LayerKind {
  convolution,
  transposed_convolution,
  activation,  ///< applied to its input
  add,         ///< two tensors of the same shape
  concatenate,
  max_pool,
  average_pool,
  softmax
};

/// A function of each value alone.
enum class Activation {
  none,
  relu,
  leaky_relu,  ///< first_parameter * x below 0
  sigmoid,
  clip  ///< between first_parameter and second_parameter
};

/// Where a convolution or pooling looks: rows, columns.
struct LayerWindow {
  std::array<std::int64_t, 2> size = {1, 1}, stride = {1, 1}, dilation = {1, 1};
  std::array<std::int64_t, 2> before = {0, 0}, after = {0, 0};  ///< padding
};

/// A layer whose operator is known, whose attributes are checked and whose shapes agree. A convolution may add a tensor
/// to its result and apply an activation to the sum.
struct PlannedLayer {
  LayerKind kind = LayerKind::activation;
  std::string name;                 ///< for messages: "'head' (Conv)"
  std::vector<std::size_t> inputs;  ///< tensors
  std::size_t output = 0;           ///< tensor
  LayerWindow window;
  std::int64_t groups = 1;
  const OnnxWeight* weights = nullptr;  ///< of the graph
  const OnnxWeight* bias = nullptr;     ///< none if it is null
  std::optional<std::size_t> added;     ///< tensor of the shape of the output
  Activation activation = Activation::none;
  float first_parameter = 0.0F, second_parameter = 0.0F;
  bool counts_padding = false;  ///< average_pool divides by the size of the window also at the border
  int axis = 1;                 ///< of concatenate and softmax
};

/// What to compute, in which order, for inputs of given shapes.
struct NetworkPlan {
  std::vector<PlaneShape> tensors;
  std::vector<PlannedLayer> layers;
  std::map<std::string, std::size_t> inputs;  ///< tensors by name
  std::vector<std::size_t> outputs;           ///< tensors, in the order that was asked for
};

/// Plans the layers that `outputs` need, with Add and activations joined to the convolutions before them. The graph
/// must outlive the plan. `file` names it in messages. Throws InputError, which names the layer, for operators,
/// attributes and shapes that are not supported or do not agree.
NetworkPlan plan_network(const OnnxGraph& graph, const std::map<std::string, std::vector<std::int64_t>>& input_shapes,
                         const std::vector<std::string>& outputs, const std::filesystem::path& file);

}  // namespace holdfast
