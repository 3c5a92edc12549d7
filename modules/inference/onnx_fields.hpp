// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

/// Numbers of onnx.proto3.
namespace holdfast::onnx {

/// Values of TensorProto.DataType.
namespace type {
constexpr std::uint64_t float32 = 1, int64 = 7, half_precision = 10, float64 = 11, uint32 = 12, uint64 = 13;
}  // namespace type

/// Field numbers.
namespace field {
constexpr std::uint32_t model_graph = 7, model_operators = 8, model_metadata = 14;
constexpr std::uint32_t metadata_key = 1, metadata_value = 2;
constexpr std::uint32_t operators_domain = 1, operators_version = 2;
constexpr std::uint32_t graph_node = 1, graph_initializer = 5, graph_input = 11, graph_output = 12;
constexpr std::uint32_t graph_sparse_initializer = 15, sparse_values = 1;
constexpr std::uint32_t node_input = 1, node_output = 2, node_name = 3, node_operator = 4, node_attribute = 5;
constexpr std::uint32_t node_domain = 7;
constexpr std::uint32_t attribute_name = 1, attribute_number = 2, attribute_integer = 3, attribute_text = 4;
constexpr std::uint32_t attribute_tensor = 5, attribute_graph = 6, attribute_integers = 8;
constexpr std::uint32_t attribute_tensors = 10, attribute_graphs = 11;
constexpr std::uint32_t tensor_dimension = 1, tensor_data_type = 2, tensor_name = 8;
constexpr std::uint32_t tensor_floats = 4, tensor_int32s = 5, tensor_int64s = 7, tensor_raw = 9, tensor_doubles = 10;
constexpr std::uint32_t tensor_uint64s = 11, tensor_location = 14;
constexpr std::uint32_t value_name = 1, value_type = 2;
constexpr std::uint32_t type_tensor = 1;
constexpr std::uint32_t tensor_type_element = 1, tensor_type_shape = 2;
constexpr std::uint32_t shape_dimension = 1;
constexpr std::uint32_t dimension_value = 1;
}  // namespace field

}  // namespace holdfast::onnx
