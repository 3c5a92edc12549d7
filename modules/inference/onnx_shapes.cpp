// SPDX-License-Identifier: BSD-3-Clause
#include "onnx_shapes.hpp"

#include "onnx_fields.hpp"
#include "protobuf.hpp"

namespace holdfast {

namespace {

using namespace protobuf;
namespace field = onnx::field;
using Written = std::vector<std::uint8_t>;

void write_varint(Written& to, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) to.push_back(static_cast<std::uint8_t>(value | 0x80));
  to.push_back(static_cast<std::uint8_t>(value));
}

void write_little_endian(Written& to, std::uint64_t bits, int bytes) {
  for (int i = 0; i < bytes; ++i) to.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
}

void write(Written& to, const Field& f) {
  write_varint(to, std::uint64_t{f.number} << 3 | f.wire);
  if (f.wire == wire_varint) write_varint(to, f.value);
  if (f.wire == wire_eight_bytes) write_little_endian(to, f.bits, 8);
  if (f.wire == wire_four_bytes) write_little_endian(to, f.bits, 4);
  if (f.wire != wire_content) return;
  write_varint(to, f.content.size());
  to.insert(to.end(), f.content.begin(), f.content.end());
}

/// The message with the content of every field of that number replaced by change(content).
template <class Change>
Written with_changed(Bytes message, std::uint32_t number, const Change& change) {
  Written result;
  result.reserve(message.size());
  each_field(message, [&](Field f) {
    Written changed;
    if (f.number == number && f.wire == wire_content) {
      changed = change(f.content);
      f.content = changed;
    }
    write(result, f);
  });
  return result;
}

Written shape_message(const std::vector<std::int64_t>& shape) {
  Written result;
  for (const std::int64_t size : shape) {
    Written dimension;
    write(dimension,
          {.number = field::dimension_value, .wire = wire_varint, .value = static_cast<std::uint64_t>(size)});
    write(result, {.number = field::shape_dimension, .wire = wire_content, .content = dimension});
  }
  return result;
}

/// A tensor's type with another shape, or with one where it had none.
Written with_shape(Bytes tensor_type, const std::vector<std::int64_t>& shape) {
  Written result;
  each_field(tensor_type, [&](const Field& f) {
    if (f.number != field::tensor_type_shape) write(result, f);
  });
  const Written message = shape_message(shape);
  write(result, {.number = field::tensor_type_shape, .wire = wire_content, .content = message});
  return result;
}

std::string name_of(Bytes value) {
  std::string name;
  each_field(value, [&](const Field& f) {
    if (f.number == field::value_name) name = text(f.content);
  });
  return name;
}

}  // namespace

std::vector<std::uint8_t> with_input_shapes(std::span<const std::uint8_t> bytes,
                                            const std::map<std::string, std::vector<std::int64_t>>& shapes) {
  return with_changed(bytes, field::model_graph, [&](Bytes graph) {
    return with_changed(graph, field::graph_input, [&](Bytes input) {
      const auto found = shapes.find(name_of(input));
      if (found == shapes.end()) return Written(input.begin(), input.end());
      return with_changed(input, field::value_type, [&](Bytes type) {
        return with_changed(type, field::type_tensor,
                            [&](Bytes tensor_type) { return with_shape(tensor_type, found->second); });
      });
    });
  });
}

}  // namespace holdfast
