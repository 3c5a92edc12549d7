// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/onnx_signature.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "holdfast/core/error.hpp"
#include "onnx_fields.hpp"
#include "protobuf.hpp"

namespace holdfast {

namespace {

using namespace onnx;
using namespace protobuf;

/// A well-formed model that OpenCV must not see: what is wrong, what was expected and what to do.
struct Unusable {
  std::string message;
};

std::int64_t read_dimension(Bytes bytes) {
  std::int64_t size = -1;
  each_field(bytes, [&](const Field& f) {
    if (f.number == field::dimension_value && f.value > 0) size = static_cast<std::int64_t>(f.value);
  });
  return size;
}

OnnxTensor read_value(Bytes bytes) {
  OnnxTensor tensor;
  each_field(bytes, [&](const Field& value) {
    if (value.number == field::value_name) tensor.name = text(value.content);
    if (value.number != field::value_type) return;
    each_field(value.content, [&](const Field& type) {
      if (type.number != field::type_tensor) return;
      each_field(type.content, [&](const Field& part) {
        if (part.number == field::tensor_type_element) tensor.element_type = static_cast<int>(part.value);
        if (part.number != field::tensor_type_shape) return;
        each_field(part.content, [&](const Field& dimension) {
          if (dimension.number == field::shape_dimension) tensor.shape.push_back(read_dimension(dimension.content));
        });
      });
    });
  });
  return tensor;
}

/// The bytes of one element, 0 for types whose tensors OpenCV refuses.
std::uint64_t element_size(std::uint64_t data_type) {
  constexpr std::array<std::uint64_t, 17> sizes = {0, 4, 1, 1, 2, 2, 4, 8, 0, 1, 2, 8, 4, 8, 0, 0, 2};
  return data_type < sizes.size() ? sizes[data_type] : 0;
}

/// The field of a tensor, beside the raw bytes, that holds elements of that type.
std::uint32_t typed_field(std::uint64_t data_type) {
  switch (data_type) {
    case type::float32:
      return field::tensor_floats;
    case type::float64:
      return field::tensor_doubles;
    case type::int64:
      return field::tensor_int64s;
    case type::uint32:
    case type::uint64:
      return field::tensor_uint64s;
    default:
      return field::tensor_int32s;
  }
}

/// The number of elements in one occurrence of a repeated field of numbers, which may be packed.
std::uint64_t count_numbers(const Field& f) {
  const std::uint32_t wire = f.number == field::tensor_floats    ? wire_four_bytes
                             : f.number == field::tensor_doubles ? wire_eight_bytes
                                                                 : wire_varint;
  if (f.wire != wire_content) return f.wire == wire ? 1 : 0;
  if (wire == wire_four_bytes) return f.content.size() / 4;
  if (wire == wire_eight_bytes) return f.content.size() / 8;
  return static_cast<std::uint64_t>(
      std::count_if(f.content.begin(), f.content.end(), [](std::uint8_t byte) { return (byte & 0x80) == 0; }));
}

void add_dimensions(const Field& f, std::vector<std::int64_t>& shape) {
  if (f.wire == wire_varint) shape.push_back(static_cast<std::int64_t>(f.value));
  Message packed(f.content);
  while (!packed.is_at_end()) shape.push_back(static_cast<std::int64_t>(packed.varint()));
}

/// Refuses a tensor with fewer elements than its dimensions say: OpenCV reads as many as they say.
void check_tensor(Bytes bytes) {
  std::string name;
  std::vector<std::int64_t> shape;
  std::uint64_t data_type = 0, raw_size = 0;
  bool is_external = false;
  each_field(bytes, [&](const Field& f) {
    if (f.number == field::tensor_name) name = text(f.content);
    if (f.number == field::tensor_dimension) add_dimensions(f, shape);
    if (f.number == field::tensor_data_type) data_type = f.value;
    if (f.number == field::tensor_raw) raw_size = f.content.size();
    if (f.number == field::tensor_location) is_external = f.value == 1;
  });
  if (is_external)
    throw Unusable{"keeps its tensor '" + name +
                   "' in another file; expected all weights inside; export it as one file"};
  if (element_size(data_type) == 0) return;
  std::uint64_t elements = 0;
  each_field(bytes, [&](const Field& f) {
    if (f.number == typed_field(data_type)) elements += count_numbers(f);
  });
  if (elements == 0) elements = raw_size / element_size(data_type);
  std::uint64_t expected = 1;
  bool fits = true;
  for (const std::int64_t size : shape) {
    fits = fits && size >= 0 && size <= std::numeric_limits<std::int32_t>::max();
    expected = fits ? expected * static_cast<std::uint64_t>(size) : 0;
    fits = fits && expected <= elements;
  }
  if (!fits || expected > elements)
    throw Unusable{"has a tensor '" + name + "' of " + shape_text(shape) + ", but data for " +
                   std::to_string(elements) + " elements; expected one for each; export or copy it again"};
}

constexpr int most_graphs = 32;  // within each other; OpenCV knows no layer with a graph inside

void check_tensors(Bytes graph, int depth);

void check_attribute(Bytes bytes, int depth) {
  bool has_tensor = false;
  each_field(bytes, [&](const Field& f) {
    if (f.number == field::attribute_tensor && std::exchange(has_tensor, true)) throw Malformed();
    if (f.number == field::attribute_tensor || f.number == field::attribute_tensors) check_tensor(f.content);
    if (f.number == field::attribute_graph || f.number == field::attribute_graphs) check_tensors(f.content, depth + 1);
  });
}

/// All tensors of a graph: its weights and those in attributes of its layers.
void check_tensors(Bytes graph, int depth) {
  if (depth > most_graphs) throw Malformed();
  each_field(graph, [&](const Field& part) {
    if (part.number == field::graph_initializer) check_tensor(part.content);
    if (part.number != field::graph_node) return;
    each_field(part.content, [&](const Field& f) {
      if (f.number == field::node_attribute) check_attribute(f.content, depth);
    });
  });
}

/// Refuses a layer with an input that nothing before it provides: OpenCV would run it without that input. `provided`
/// holds the names of inputs and weights, and gets those of the layers' outputs.
void check_layers(const std::vector<Bytes>& layers, std::set<std::string>& provided) {
  for (const Bytes layer : layers) {
    std::string name, kind, missing;
    bool has_input = false;
    std::vector<std::string> outputs;
    each_field(layer, [&](const Field& f) {
      if (f.number == field::node_name) name = text(f.content);
      if (f.number == field::node_operator) kind = text(f.content);
      if (f.number == field::node_output) outputs.push_back(text(f.content));
      if (f.number != field::node_input || f.content.empty()) return;  // an empty name leaves an input out
      has_input = true;
      if (provided.count(text(f.content)) == 0) missing = text(f.content);
    });
    if (!has_input && kind != "Constant")
      throw Unusable{"has a layer '" + name + "' (" + kind +
                     ") without an input; expected a whole network; export it again"};
    if (!missing.empty())
      throw Unusable{
          "has a layer '" + name + "' (" + kind + ") that reads '" + missing +
          "', which no input, weight or layer before it provides; expected a whole network; export it again"};
    provided.insert(outputs.begin(), outputs.end());
  }
}

/// Where the values of a tensor come from: an operator, and its first input.
struct Producer {
  std::string kind, input;
};

/// The operator that computes the values of the tensor `name`, behind those that keep them.
std::string computing_operator(const std::map<std::string, Producer>& producers, std::string name) {
  static const std::set<std::string> keeps_values = {"Cast",  "Flatten", "Identity",  "Reshape",   "Resize",
                                                     "Slice", "Squeeze", "Transpose", "Unsqueeze", "Upsample"};
  for (std::size_t step = 0; step <= producers.size(); ++step) {
    const auto producer = producers.find(name);
    if (producer == producers.end()) break;
    if (!keeps_values.contains(producer->second.kind)) return producer->second.kind;
    name = producer->second.input;
  }
  return "";
}

std::map<std::string, Producer> producers_of(const std::vector<Bytes>& layers) {
  std::map<std::string, Producer> producers;
  for (const Bytes layer : layers) {
    Producer producer;
    std::vector<std::string> outputs;
    bool has_input = false;
    each_field(layer, [&](const Field& f) {
      if (f.number == field::node_operator) producer.kind = text(f.content);
      if (f.number == field::node_output) outputs.push_back(text(f.content));
      if (f.number == field::node_input && !std::exchange(has_input, true)) producer.input = text(f.content);
    });
    for (const std::string& output : outputs) producers[output] = producer;
  }
  return producers;
}

OnnxSignature read_graph(Bytes bytes) {
  OnnxSignature signature;
  std::set<std::string> weights;
  std::vector<Bytes> layers;
  check_tensors(bytes, 0);
  each_field(bytes, [&](const Field& part) {
    if (part.number == field::graph_input) signature.inputs.push_back(read_value(part.content));
    if (part.number == field::graph_output) signature.outputs.push_back(read_value(part.content));
    if (part.number == field::graph_node) layers.push_back(part.content);
    if (part.number == field::graph_sparse_initializer)
      each_field(part.content, [&](const Field& sparse) {
        if (sparse.number != field::sparse_values) return;
        each_field(sparse.content, [&](const Field& weight) {
          if (weight.number == field::tensor_name) weights.insert(text(weight.content));
        });
      });
    if (part.number != field::graph_initializer) return;
    each_field(part.content, [&](const Field& weight) {
      if (weight.number == field::tensor_name) weights.insert(text(weight.content));
      if (weight.number == field::tensor_data_type)
        signature.has_half_precision |= weight.value == type::half_precision;
    });
  });
  std::set<std::string> provided = weights;
  for (const OnnxTensor& input : signature.inputs) provided.insert(input.name);
  check_layers(layers, provided);
  for (const OnnxTensor& output : signature.outputs)
    if (provided.count(output.name) == 0)
      throw Unusable{"declares an output '" + output.name + "', which no layer provides; export it again"};
  const std::map<std::string, Producer> producers = producers_of(layers);
  for (OnnxTensor& output : signature.outputs) output.computed_by = computing_operator(producers, output.name);
  std::erase_if(signature.inputs, [&](const OnnxTensor& input) { return weights.count(input.name) > 0; });
  const auto is_half = [](const OnnxTensor& tensor) {
    return tensor.element_type == static_cast<int>(type::half_precision);
  };
  signature.has_half_precision |= std::any_of(signature.inputs.begin(), signature.inputs.end(), is_half) ||
                                  std::any_of(signature.outputs.begin(), signature.outputs.end(), is_half);
  return signature;
}

/// An entry of the metadata; the first of a key counts.
void read_metadata(Bytes entry, std::map<std::string, std::string>& metadata) {
  std::string key, value;
  each_field(entry, [&](const Field& f) {
    if (f.number == field::metadata_key) key = text(f.content);
    if (f.number == field::metadata_value) value = text(f.content);
  });
  metadata.emplace(std::move(key), std::move(value));
}

}  // namespace

std::string shape_text(std::span<const std::int64_t> shape) {
  std::string result;
  for (const std::int64_t size : shape) result += (result.empty() ? "" : "x") + (size < 0 ? "?" : std::to_string(size));
  return result.empty() ? "nothing" : result;
}

std::string OnnxTensor::shape_text() const { return holdfast::shape_text(shape); }

OnnxSignature read_onnx_signature(std::span<const std::uint8_t> bytes, const std::filesystem::path& file) {
  std::optional<OnnxSignature> signature;
  std::map<std::string, std::string> metadata;
  try {
    protobuf::each_field(bytes, [&](const protobuf::Field& part) {
      if (part.number == onnx::field::model_metadata) read_metadata(part.content, metadata);
      if (part.number != onnx::field::model_graph || part.content.empty()) return;
      if (signature) throw protobuf::Malformed();
      signature = read_graph(part.content);
    });
  } catch (const protobuf::Malformed&) {
    signature.reset();
  } catch (const Unusable& model) {
    throw InputError({file.string()}, model.message);
  }
  if (!signature || signature->inputs.empty() || signature->outputs.empty())
    throw InputError({file.string()}, "is not a whole ONNX model of " + std::to_string(bytes.size()) +
                                          " bytes; expected a network exported to ONNX; export or copy it again");
  signature->metadata = std::move(metadata);
  return *signature;
}

}  // namespace holdfast
