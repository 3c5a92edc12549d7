// SPDX-License-Identifier: BSD-3-Clause
#include "onnx_graph.hpp"

#include <bit>
#include <utility>

#include "holdfast/core/error.hpp"
#include "onnx_fields.hpp"
#include "protobuf.hpp"

namespace holdfast {

namespace {

using protobuf::Bytes, protobuf::each_field, protobuf::Message;
using GraphField = protobuf::Field;
namespace onnx_field = onnx::field;

/// A repeated field of whole numbers, packed or one by one.
void add_integers(const GraphField& f, std::vector<std::int64_t>& values) {
  if (f.wire == protobuf::wire_varint) values.push_back(static_cast<std::int64_t>(f.value));
  if (f.wire != protobuf::wire_content) return;
  Message packed(f.content);
  while (!packed.is_at_end()) values.push_back(static_cast<std::int64_t>(packed.varint()));
}

std::uint64_t little_endian(Bytes bytes, std::size_t first, std::size_t count) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < count; ++i) bits |= std::uint64_t{bytes[first + i]} << (8 * i);
  return bits;
}

float to_float(std::uint64_t bits) { return std::bit_cast<float>(static_cast<std::uint32_t>(bits)); }

void add_floats(Bytes bytes, std::vector<float>& values) {
  for (std::size_t i = 0; i + 4 <= bytes.size(); i += 4) values.push_back(to_float(little_endian(bytes, i, 4)));
}

std::pair<std::string, OnnxWeight> read_weight(Bytes bytes, const std::filesystem::path& file) {
  std::string name;
  OnnxWeight weight;
  Bytes raw;
  each_field(bytes, [&](const GraphField& f) {
    if (f.number == onnx_field::tensor_name) name = protobuf::text(f.content);
    if (f.number == onnx_field::tensor_dimension) add_integers(f, weight.shape);
    if (f.number == onnx_field::tensor_data_type) weight.element_type = static_cast<int>(f.value);
    if (f.number == onnx_field::tensor_raw) raw = f.content;
  });
  const bool is_float = weight.element_type == static_cast<int>(onnx::type::float32);
  const bool is_integer = weight.element_type == static_cast<int>(onnx::type::int64);
  if (!is_float && !is_integer) return {name, weight};
  each_field(bytes, [&](const GraphField& f) {
    if (is_integer && f.number == onnx_field::tensor_int64s) add_integers(f, weight.integers);
    if (!is_float || f.number != onnx_field::tensor_floats) return;
    if (f.wire == protobuf::wire_four_bytes) weight.numbers.push_back(to_float(f.bits));
    add_floats(f.content, weight.numbers);
  });
  if (is_float && weight.numbers.empty()) add_floats(raw, weight.numbers);
  if (is_integer && weight.integers.empty())
    for (std::size_t i = 0; i + 8 <= raw.size(); i += 8)
      weight.integers.push_back(static_cast<std::int64_t>(little_endian(raw, i, 8)));
  const std::uint64_t found = is_float ? weight.numbers.size() : weight.integers.size();
  // The signature's reader has seen that there is a number for each element, so that the product does not overflow.
  std::uint64_t expected = 1;
  for (const std::int64_t size : weight.shape) expected *= static_cast<std::uint64_t>(size);
  if (found != expected)
    throw InputError({file.string()}, "has a tensor '" + name + "' of " + shape_text(weight.shape) + " with " +
                                          std::to_string(found) + " numbers; expected " + std::to_string(expected) +
                                          "; export or copy it again");
  return {name, std::move(weight)};
}

OnnxNode read_node(Bytes bytes) {
  OnnxNode node;
  each_field(bytes, [&](const GraphField& f) {
    if (f.number == onnx_field::node_name) node.name = protobuf::text(f.content);
    if (f.number == onnx_field::node_operator) node.kind = protobuf::text(f.content);
    if (f.number == onnx_field::node_domain) node.domain = protobuf::text(f.content);
    if (f.number == onnx_field::node_input) node.inputs.push_back(protobuf::text(f.content));
    if (f.number == onnx_field::node_output) node.outputs.push_back(protobuf::text(f.content));
    if (f.number != onnx_field::node_attribute) return;
    std::string name;
    OnnxAttribute attribute;
    each_field(f.content, [&](const GraphField& part) {
      if (part.number == onnx_field::attribute_name) name = protobuf::text(part.content);
      if (part.number == onnx_field::attribute_number) attribute.number = to_float(part.bits);
      if (part.number == onnx_field::attribute_integer) attribute.integer = static_cast<std::int64_t>(part.value);
      if (part.number == onnx_field::attribute_text) attribute.text = protobuf::text(part.content);
      if (part.number == onnx_field::attribute_integers) add_integers(part, attribute.integers);
    });
    node.attributes[name] = std::move(attribute);
  });
  return node;
}

void read_parts(Bytes bytes, const std::filesystem::path& file, OnnxGraph& graph) {
  each_field(bytes, [&](const GraphField& part) {
    if (part.number == onnx_field::model_operators) {
      std::string domain;
      std::int64_t version = 0;
      each_field(part.content, [&](const GraphField& f) {
        if (f.number == onnx_field::operators_domain) domain = protobuf::text(f.content);
        if (f.number == onnx_field::operators_version) version = static_cast<std::int64_t>(f.value);
      });
      if (domain.empty() || domain == "ai.onnx") graph.opset = version;
    }
    if (part.number != onnx_field::model_graph) return;
    each_field(part.content, [&](const GraphField& f) {
      if (f.number == onnx_field::graph_initializer) graph.weights.insert(read_weight(f.content, file));
      if (f.number == onnx_field::graph_node) graph.nodes.push_back(read_node(f.content));
    });
  });
}

}  // namespace

OnnxGraph read_onnx_graph(std::span<const std::uint8_t> bytes, const std::filesystem::path& file) {
  OnnxGraph graph;
  graph.signature = read_onnx_signature(bytes, file);
  try {
    read_parts(bytes, file, graph);
  } catch (const protobuf::Malformed&) {
    throw InputError({file.string()}, "has a layer with an attribute that cannot be read; export or copy it again");
  }
  return graph;
}

}  // namespace holdfast
