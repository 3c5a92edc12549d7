// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace holdfast {

/// An input or output of a network, as its file declares it.
struct OnnxTensor {
  std::string name;
  int element_type = 0;             ///< TensorProto.DataType: 1 = float, 7 = int64, 10 = float16, ...
  std::vector<std::int64_t> shape;  ///< -1 where the size is free; empty where nothing is declared

  /// "1x3x480x640", '?' where the size is free.
  std::string shape_text() const;
};

/// What an ONNX file says about itself before it is loaded.
struct OnnxSignature {
  std::vector<OnnxTensor> inputs;  ///< without weights, which older files list as inputs too
  std::vector<OnnxTensor> outputs;
  bool has_half_precision = false;  ///< a weight, an input or an output is float16
};

std::string shape_text(std::span<const std::int64_t> shape);

/// Reads the parts of an ONNX file (a ModelProto in the encoding of Protocol Buffers) that declare inputs and outputs,
/// because the inference library does not tell them. `file` names it in messages. Throws InputError for bytes that are
/// no ONNX model.
OnnxSignature read_onnx_signature(std::span<const std::uint8_t> bytes, const std::filesystem::path& file);

}  // namespace holdfast
