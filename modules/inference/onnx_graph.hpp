// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "holdfast/inference/onnx_signature.hpp"

namespace holdfast {

/// A tensor with its values in an ONNX file. Only float32 and int64 are read; of other types the values are empty.
struct OnnxWeight {
  int element_type = 0;             ///< TensorProto.DataType: 1 = float, 7 = int64, ...
  std::vector<std::int64_t> shape;  ///< empty for a single number
  std::vector<float> numbers;       ///< as many as the shape says, for float32
  std::vector<std::int64_t> integers;
};

/// An attribute of a layer. Those of other kinds (tensors, graphs) have only their name.
struct OnnxAttribute {
  float number = 0.0F;
  std::int64_t integer = 0;
  std::string text;
  std::vector<std::int64_t> integers;
};

/// A layer of a network.
struct OnnxNode {
  std::string name;
  std::string kind;    ///< the operator, such as "Conv"
  std::string domain;  ///< empty for the operators of ONNX itself
  std::vector<std::string> inputs, outputs;
  std::map<std::string, OnnxAttribute> attributes;
};

/// A network as its file says it, before anything is known about its operators.
struct OnnxGraph {
  OnnxSignature signature;
  std::int64_t opset = 0;       ///< version of ONNX's own operators
  std::vector<OnnxNode> nodes;  ///< each after those that it reads
  std::map<std::string, OnnxWeight> weights;
};

/// Reads an ONNX file as a whole. `file` names it in messages. Throws InputError for what read_onnx_signature() refuses
/// and for tensors without the values that their shape says.
OnnxGraph read_onnx_graph(std::span<const std::uint8_t> bytes, const std::filesystem::path& file);

}  // namespace holdfast
