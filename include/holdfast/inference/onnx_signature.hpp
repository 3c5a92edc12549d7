// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace holdfast {

/// An input or output of a network, as declared in its file.
struct OnnxTensor {
  std::string name;
  int element_type = 0;             ///< TensorProto.DataType: 1 = float, 7 = int64, 10 = float16, ...
  std::vector<std::int64_t> shape;  ///< -1 for a free dimension; empty if nothing is declared
  /// Of an output: the operator that computes its values ("Conv", "ArgMax"). Operators behind it that only move, resize
  /// or convert them are skipped.
  std::string computed_by = {};

  /// Shape as text, such as "1x3x480x640", with '?' for a free dimension.
  std::string shape_text() const;
};

/// Declarations of an ONNX file, read before the model is loaded.
struct OnnxSignature {
  std::vector<OnnxTensor> inputs;  ///< without weights, which older files also list as inputs
  std::vector<OnnxTensor> outputs;
  bool has_half_precision = false;  ///< a weight, an input or an output is float16
  /// What the exporter noted about the model (metadata_props), by key.
  std::map<std::string, std::string> metadata = {};
};

std::string shape_text(std::span<const std::int64_t> shape);

/// Parses the declarations of inputs and outputs of an ONNX file (a ModelProto in Protocol Buffers encoding), which the
/// inference library does not provide. `file` names it in messages. Throws InputError for bytes that are not an ONNX
/// model, and for models that OpenCV would read beyond its data or run without an input: a tensor with dimensions
/// larger than its data, a layer that reads what nothing before it provides.
OnnxSignature read_onnx_signature(std::span<const std::uint8_t> bytes, const std::filesystem::path& file);

}  // namespace holdfast
