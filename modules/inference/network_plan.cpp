// SPDX-License-Identifier: BSD-3-Clause
#include "network_plan.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "holdfast/core/error.hpp"
#include "layer_fusion.hpp"

namespace holdfast {

namespace {

/// Values of a tensor; a network that needs more is a mistake.
constexpr std::int64_t max_values = std::int64_t{1} << 28;
/// Strides, dilations and paddings.
constexpr std::int64_t max_step = 1 << 16;

std::string name_of(const OnnxNode& node) { return "'" + node.name + "' (" + node.kind + ")"; }

std::string text_of(const PlaneShape& shape) { return shape_text(shape); }

/// Plans one layer after the other.
class Planner {
 public:
  Planner(const OnnxGraph& graph, const std::filesystem::path& file) : graph_(graph), file_(file) {}

  NetworkPlan plan(const std::map<std::string, std::vector<std::int64_t>>& input_shapes,
                   const std::vector<std::string>& outputs) {
    for (const auto& [name, shape] : input_shapes) {
      if (shape.size() != 4)
        throw InputError({file_.string()}, "gets an input '" + name + "' of " + shape_text(shape) +
                                               "; the engine onednn expects four dimensions; `engine: opencv` takes "
                                               "others");
      plan_.inputs[name] = add_tensor(name, {shape[0], shape[1], shape[2], shape[3]}, "the input");
    }
    const std::vector<bool> needed = needed_nodes(outputs);
    for (std::size_t i = 0; i < graph_.nodes.size(); ++i)
      if (needed[i]) add_layer(graph_.nodes[i]);
    for (const std::string& name : outputs) plan_.outputs.push_back(tensor(name, "the output"));
    join_layers(plan_);
    return std::move(plan_);
  }

 private:
  [[noreturn]] void fail(const std::string& who, const std::string& message) const {
    throw InputError({file_.string()}, "has a layer " + who + " " + message);
  }
  [[noreturn]] void refuse(const OnnxNode& node, const std::string& message) const {
    fail(name_of(node), message + "; `engine: opencv` may read it");
  }

  std::vector<bool> needed_nodes(const std::vector<std::string>& outputs) const {
    std::set<std::string> wanted(outputs.begin(), outputs.end());
    std::vector<bool> needed(graph_.nodes.size(), false);
    for (std::size_t i = graph_.nodes.size(); i-- > 0;) {
      const OnnxNode& node = graph_.nodes[i];
      needed[i] = std::any_of(node.outputs.begin(), node.outputs.end(),
                              [&](const std::string& name) { return !name.empty() && wanted.count(name) > 0; });
      if (needed[i]) wanted.insert(node.inputs.begin(), node.inputs.end());
    }
    return needed;
  }

  std::size_t add_tensor(const std::string& name, const PlaneShape& shape, const std::string& who) {
    std::int64_t values = 1;
    for (const std::int64_t size : shape) {
      if (size < 1 || size > max_values || (values *= size) > max_values)
        throw InputError({file_.string()}, "would make a tensor of " + text_of(shape) + " (" + who +
                                               "); expected 1 to " + std::to_string(max_values) +
                                               " numbers; check width and height");
    }
    tensors_[name] = plan_.tensors.size();
    plan_.tensors.push_back(shape);
    return plan_.tensors.size() - 1;
  }

  std::size_t tensor(const std::string& name, const std::string& who) const {
    const auto found = tensors_.find(name);
    if (found == tensors_.end())
      throw InputError({file_.string()}, "has no tensor '" + name + "' that is computed, which " + who +
                                             " needs; `engine: opencv` may read it");
    return found->second;
  }

  void require_attributes(const OnnxNode& node, const std::set<std::string>& known) const {
    for (const auto& [name, attribute] : node.attributes)
      if (known.count(name) == 0)
        refuse(node, "with an attribute '" + name + "', which the engine onednn does not know");
  }
  void require_inputs(const OnnxNode& node, std::size_t least, std::size_t most) const {
    if (node.inputs.size() < least || node.inputs.size() > most || node.outputs.size() != 1)
      refuse(node, "with " + std::to_string(node.inputs.size()) + " inputs and " + std::to_string(node.outputs.size()) +
                       " outputs; expected " + std::to_string(least) +
                       (most > least ? " to " + std::to_string(most) : std::string()) + " and 1");
  }

  const OnnxWeight& weight(const OnnxNode& node, std::size_t input) const {
    const auto found = graph_.weights.find(node.inputs[input]);
    if (found == graph_.weights.end() || found->second.numbers.empty())
      refuse(node, "that reads '" + node.inputs[input] + "'; expected weights of the file, of type float32");
    return found->second;
  }

  std::int64_t integer(const OnnxNode& node, const char* name, std::int64_t otherwise) const {
    const auto found = node.attributes.find(name);
    return found == node.attributes.end() ? otherwise : found->second.integer;
  }
  float number(const OnnxNode& node, const char* name, float otherwise) const {
    const auto found = node.attributes.find(name);
    return found == node.attributes.end() ? otherwise : found->second.number;
  }
  /// As many numbers as `otherwise` has, none below `least`.
  std::vector<std::int64_t> integers(const OnnxNode& node, const char* name, std::vector<std::int64_t> otherwise,
                                     std::int64_t least) const {
    const auto found = node.attributes.find(name);
    if (found == node.attributes.end()) return otherwise;
    const std::vector<std::int64_t>& values = found->second.integers;
    const bool fits = values.size() == otherwise.size() && std::all_of(values.begin(), values.end(), [&](auto value) {
                        return value >= least && value <= max_step;
                      });
    if (!fits)
      refuse(node, "with " + std::string(name) + " " + shape_text(values) + "; expected " +
                       std::to_string(otherwise.size()) + " numbers from " + std::to_string(least) + " to " +
                       std::to_string(max_step));
    return values;
  }
  int axis(const OnnxNode& node, std::int64_t otherwise) const {
    const std::int64_t value = integer(node, "axis", otherwise);
    if (value < -4 || value > 3) refuse(node, "with axis " + std::to_string(value) + "; expected -4 to 3");
    return static_cast<int>(value < 0 ? value + 4 : value);
  }

  LayerWindow window(const OnnxNode& node, const PlaneShape& from, std::array<std::int64_t, 2> size) const {
    LayerWindow result;
    result.size = size;
    const auto stride = integers(node, "strides", {1, 1}, 1), dilation = integers(node, "dilations", {1, 1}, 1);
    const auto padding = integers(node, "pads", {0, 0, 0, 0}, 0);
    result.stride = {stride[0], stride[1]};
    result.dilation = {dilation[0], dilation[1]};
    result.before = {padding[0], padding[1]};
    result.after = {padding[2], padding[3]};
    const auto found = node.attributes.find("auto_pad");
    const std::string automatic = found == node.attributes.end() ? "NOTSET" : found->second.text;
    if (automatic == "SAME_UPPER" && node.kind != "ConvTranspose") {
      for (std::size_t i = 0; i < 2; ++i) {
        const std::int64_t reach = (size[i] - 1) * dilation[i] + 1, steps = (from[2 + i] - 1) / stride[i];
        const std::int64_t total = std::max<std::int64_t>(0, steps * stride[i] + reach - from[2 + i]);
        result.before[i] = total / 2;
        result.after[i] = total - total / 2;
      }
    } else if (automatic != "NOTSET" && automatic != "VALID") {
      refuse(node, "with auto_pad " + automatic + ", which the engine onednn does not know");
    }
    return result;
  }

  /// The number of positions of a window.
  std::int64_t positions(const OnnxNode& node, const LayerWindow& window, const PlaneShape& from, std::size_t i) const {
    const std::int64_t reach = (window.size[i] - 1) * window.dilation[i] + 1;
    const std::int64_t extent = from[2 + i] + window.before[i] + window.after[i] - reach;
    if (extent < 0)
      refuse(node, "whose window of " + std::to_string(reach) + " is larger than its input of " + text_of(from));
    return extent / window.stride[i] + 1;
  }

  PlannedLayer begin(const OnnxNode& node, LayerKind kind) const {
    PlannedLayer layer;
    layer.kind = kind;
    layer.name = name_of(node);
    layer.inputs.push_back(tensor(node.inputs[0], "the layer " + layer.name));
    return layer;
  }
  void finish(const OnnxNode& node, PlannedLayer layer, const PlaneShape& shape) {
    layer.output = add_tensor(node.outputs[0], shape, "the layer " + layer.name);
    plan_.layers.push_back(std::move(layer));
  }
  const PlaneShape& shape_of(const PlannedLayer& layer) const { return plan_.tensors[layer.inputs.front()]; }

  void add_convolution(const OnnxNode& node) {
    const bool is_transposed = node.kind == "ConvTranspose";
    require_inputs(node, 2, 3);
    std::set<std::string> known = {"auto_pad", "dilations", "group", "kernel_shape", "pads", "strides"};
    if (is_transposed) known.insert("output_padding");
    require_attributes(node, known);
    PlannedLayer layer = begin(node, is_transposed ? LayerKind::transposed_convolution : LayerKind::convolution);
    const PlaneShape from = shape_of(layer);
    layer.weights = &weight(node, 1);
    const std::vector<std::int64_t>& shape = layer.weights->shape;
    layer.groups = integer(node, "group", 1);
    const bool fits = shape.size() == 4 && layer.groups >= 1 && layer.groups <= from[1] &&
                      (is_transposed ? shape[0] == from[1] && shape[0] % layer.groups == 0 && shape[1] <= max_step
                                     : shape[1] == from[1] / layer.groups && from[1] % layer.groups == 0 &&
                                           shape[0] % layer.groups == 0);
    if (!fits)
      refuse(node, "with weights of " + shape_text(shape) + " in " + std::to_string(layer.groups) +
                       " groups for an input of " + text_of(from) + ", which do not agree");
    const std::int64_t channels = is_transposed ? shape[1] * layer.groups : shape[0];
    if (integers(node, "kernel_shape", {shape[2], shape[3]}, 1) != std::vector<std::int64_t>{shape[2], shape[3]})
      refuse(node, "whose kernel_shape is not that of its weights, " + shape_text(shape));
    if (node.inputs.size() == 3 && !node.inputs[2].empty()) {
      layer.bias = &weight(node, 2);
      if (layer.bias->shape != std::vector<std::int64_t>{channels})
        refuse(node, "with a bias of " + shape_text(layer.bias->shape) + "; expected " + std::to_string(channels));
    }
    layer.window = window(node, from, {shape[2], shape[3]});
    PlaneShape to = {from[0], channels, 1, 1};
    const auto more = integers(node, "output_padding", {0, 0}, 0);
    for (std::size_t i = 0; i < 2; ++i) {
      if (!is_transposed) {
        to[2 + i] = positions(node, layer.window, from, i);
        continue;
      }
      layer.window.after[i] -= more[i];
      if (layer.window.after[i] < 0)
        refuse(node, "with more output_padding than pads, which the engine onednn does not know");
      to[2 + i] = (from[2 + i] - 1) * layer.window.stride[i] + (shape[2 + i] - 1) * layer.window.dilation[i] + 1 -
                  layer.window.before[i] - layer.window.after[i];
    }
    finish(node, std::move(layer), to);
  }

  void add_pool(const OnnxNode& node) {
    const bool is_maximum = node.kind == "MaxPool";
    require_inputs(node, 1, 1);
    require_attributes(node, {"auto_pad", "ceil_mode", "count_include_pad", "dilations", "kernel_shape", "pads",
                              "storage_order", "strides"});
    PlannedLayer layer = begin(node, is_maximum ? LayerKind::max_pool : LayerKind::average_pool);
    const PlaneShape from = shape_of(layer);
    const auto size = integers(node, "kernel_shape", {0, 0}, 1);
    if (size[0] == 0) refuse(node, "without kernel_shape; expected two numbers");
    layer.window = window(node, from, {size[0], size[1]});
    layer.counts_padding = integer(node, "count_include_pad", 0) != 0;
    bool fits = integer(node, "ceil_mode", 0) == 0;
    for (std::size_t i = 0; i < 2; ++i)
      fits =
          fits && layer.window.dilation[i] == 1 && layer.window.before[i] < size[i] && layer.window.after[i] < size[i];
    if (!fits) refuse(node, "with ceil_mode, dilations or pads that the engine onednn does not know");
    finish(node, layer,
           {from[0], from[1], positions(node, layer.window, from, 0), positions(node, layer.window, from, 1)});
  }

  void add_sum(const OnnxNode& node) {
    require_inputs(node, 2, 2);
    require_attributes(node, {});
    PlannedLayer layer = begin(node, LayerKind::add);
    layer.inputs.push_back(tensor(node.inputs[1], "the layer " + layer.name));
    const PlaneShape shape = shape_of(layer), other = plan_.tensors[layer.inputs[1]];
    if (shape != other) refuse(node, "that adds " + text_of(shape) + " and " + text_of(other) + "; expected one shape");
    finish(node, layer, shape);
  }

  void add_concatenation(const OnnxNode& node) {
    require_inputs(node, 1, max_step);
    require_attributes(node, {"axis"});
    PlannedLayer layer = begin(node, LayerKind::concatenate);
    layer.axis = axis(node, 1);
    const auto along = static_cast<std::size_t>(layer.axis);
    PlaneShape shape = shape_of(layer);
    for (std::size_t i = 1; i < node.inputs.size(); ++i) {
      layer.inputs.push_back(tensor(node.inputs[i], "the layer " + layer.name));
      PlaneShape other = plan_.tensors[layer.inputs.back()];
      shape[along] += std::exchange(other[along], shape[along] + other[along]);
      if (shape != other)
        refuse(node, "that joins tensors of different sizes, up to " + text_of(other) +
                         "; check width and height: are they multiples of what the network halves?");
    }
    finish(node, layer, shape);
  }

  void add_softmax(const OnnxNode& node) {
    require_inputs(node, 1, 1);
    require_attributes(node, {"axis"});
    if (graph_.opset < 13)
      refuse(node, "of opset " + std::to_string(graph_.opset) + ", whose Softmax flattens; expected opset 13 or later");
    PlannedLayer layer = begin(node, LayerKind::softmax);
    layer.axis = axis(node, -1);
    finish(node, layer, shape_of(layer));
  }

  void add_activation(const OnnxNode& node, Activation activation) {
    require_inputs(node, 1, activation == Activation::clip ? 3 : 1);
    require_attributes(node, activation == Activation::leaky_relu ? std::set<std::string>{"alpha"}
                             : activation == Activation::clip     ? std::set<std::string>{"max", "min"}
                                                                  : std::set<std::string>{});
    PlannedLayer layer = begin(node, LayerKind::activation);
    layer.activation = activation;
    if (activation == Activation::leaky_relu) layer.first_parameter = number(node, "alpha", 0.01F);
    if (activation == Activation::clip) {
      constexpr float largest = std::numeric_limits<float>::max();
      layer.first_parameter = bound(node, 1, "min", -largest);
      layer.second_parameter = bound(node, 2, "max", largest);
    }
    finish(node, layer, shape_of(layer));
  }
  /// A limit of Clip, which newer files keep as a tensor.
  float bound(const OnnxNode& node, std::size_t input, const char* name, float otherwise) const {
    if (input >= node.inputs.size() || node.inputs[input].empty()) return number(node, name, otherwise);
    const OnnxWeight& limit = weight(node, input);
    if (limit.numbers.size() != 1) refuse(node, "with limits of " + shape_text(limit.shape) + "; expected one number");
    return limit.numbers.front();
  }

  void add_layer(const OnnxNode& node) {
    const std::string& kind = node.kind;
    if (!node.domain.empty() && node.domain != "ai.onnx")
      refuse(node, "of the domain '" + node.domain + "', which the engine onednn does not know");
    if (kind == "Conv" || kind == "ConvTranspose") return add_convolution(node);
    if (kind == "MaxPool" || kind == "AveragePool") return add_pool(node);
    if (kind == "Add") return add_sum(node);
    if (kind == "Concat") return add_concatenation(node);
    if (kind == "Softmax") return add_softmax(node);
    if (kind == "Relu") return add_activation(node, Activation::relu);
    if (kind == "LeakyRelu") return add_activation(node, Activation::leaky_relu);
    if (kind == "Sigmoid") return add_activation(node, Activation::sigmoid);
    if (kind == "Clip") return add_activation(node, Activation::clip);
    refuse(node,
           "that the engine onednn does not know; it knows Add, AveragePool, Clip, Concat, Conv, ConvTranspose, "
           "LeakyRelu, MaxPool, Relu, Sigmoid and Softmax");
  }

  const OnnxGraph& graph_;
  const std::filesystem::path& file_;
  std::map<std::string, std::size_t> tensors_;
  NetworkPlan plan_;
};

}  // namespace

NetworkPlan plan_network(const OnnxGraph& graph, const std::map<std::string, std::vector<std::int64_t>>& input_shapes,
                         const std::vector<std::string>& outputs, const std::filesystem::path& file) {
  return Planner(graph, file).plan(input_shapes, outputs);
}

}  // namespace holdfast
