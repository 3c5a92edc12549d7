// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/onnx_signature.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include "holdfast/core/error.hpp"

namespace holdfast {

namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr int half_precision = 10;  // TensorProto.DataType.FLOAT16

/// Field numbers of onnx.proto3.
namespace field {
constexpr std::uint32_t model_graph = 7;
constexpr std::uint32_t graph_initializer = 5, graph_input = 11, graph_output = 12;
constexpr std::uint32_t tensor_data_type = 2, tensor_name = 8;
constexpr std::uint32_t value_name = 1, value_type = 2;
constexpr std::uint32_t type_tensor = 1;
constexpr std::uint32_t tensor_type_element = 1, tensor_type_shape = 2;
constexpr std::uint32_t shape_dimension = 1;
constexpr std::uint32_t dimension_value = 1;
}  // namespace field

struct Field {
  std::uint32_t number = 0;
  std::uint64_t value = 0;  ///< of a varint
  Bytes content;            ///< of a length-delimited field
};

struct Malformed {};

/// The fields of a message, one after the other.
class Message {
 public:
  explicit Message(Bytes bytes) : rest_(bytes) {}

  std::optional<Field> next() {
    if (rest_.empty()) return std::nullopt;
    const std::uint64_t key = varint();
    Field result;
    result.number = static_cast<std::uint32_t>(key >> 3);
    if (result.number == 0) throw Malformed();
    switch (key & 7) {
      case 0:
        result.value = varint();
        break;
      case 1:
        take(8);
        break;
      case 2:
        result.content = take(varint());
        break;
      case 5:
        take(4);
        break;
      default:
        throw Malformed();
    }
    return result;
  }

 private:
  Bytes take(std::uint64_t count) {
    if (count > rest_.size()) throw Malformed();
    const Bytes taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const std::uint8_t byte = take(1)[0];
      value |= std::uint64_t{byte & 0x7fU} << shift;
      if ((byte & 0x80) == 0) return value;
    }
    throw Malformed();
  }

  Bytes rest_;
};

template <class Visit>
void each_field(Bytes bytes, Visit&& visit) {
  Message message(bytes);
  while (const std::optional<Field> found = message.next()) visit(*found);
}

std::string text(Bytes bytes) { return {bytes.begin(), bytes.end()}; }

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

OnnxSignature read_graph(Bytes bytes) {
  OnnxSignature signature;
  std::set<std::string> weights;
  each_field(bytes, [&](const Field& part) {
    if (part.number == field::graph_input) signature.inputs.push_back(read_value(part.content));
    if (part.number == field::graph_output) signature.outputs.push_back(read_value(part.content));
    if (part.number != field::graph_initializer) return;
    each_field(part.content, [&](const Field& weight) {
      if (weight.number == field::tensor_name) weights.insert(text(weight.content));
      if (weight.number == field::tensor_data_type) signature.has_half_precision |= weight.value == half_precision;
    });
  });
  std::erase_if(signature.inputs, [&](const OnnxTensor& input) { return weights.count(input.name) > 0; });
  const auto is_half = [](const OnnxTensor& tensor) { return tensor.element_type == half_precision; };
  signature.has_half_precision |= std::any_of(signature.inputs.begin(), signature.inputs.end(), is_half) ||
                                  std::any_of(signature.outputs.begin(), signature.outputs.end(), is_half);
  return signature;
}

}  // namespace

std::string shape_text(std::span<const std::int64_t> shape) {
  std::string result;
  for (const std::int64_t size : shape) result += (result.empty() ? "" : "x") + (size < 0 ? "?" : std::to_string(size));
  return result.empty() ? "nothing" : result;
}

std::string OnnxTensor::shape_text() const { return holdfast::shape_text(shape); }

OnnxSignature read_onnx_signature(Bytes bytes, const std::filesystem::path& file) {
  std::optional<OnnxSignature> signature;
  try {
    each_field(bytes, [&](const Field& part) {
      if (part.number == field::model_graph && !part.content.empty()) signature = read_graph(part.content);
    });
  } catch (const Malformed&) {
    signature.reset();
  }
  if (!signature || signature->inputs.empty() || signature->outputs.empty())
    throw InputError({file.string()}, "is not a whole ONNX model of " + std::to_string(bytes.size()) +
                                          " bytes; expected a network exported to ONNX; export or copy it again");
  return *signature;
}

}  // namespace holdfast
