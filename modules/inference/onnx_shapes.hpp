// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace holdfast {

/// A copy of an ONNX model that declares these shapes for its inputs, by name, in place of its own. Importers that
/// infer shapes while they read (OpenCV 4.10) fail at sizes that are left open. `bytes`: a model that
/// read_onnx_signature() accepts.
std::vector<std::uint8_t> with_input_shapes(std::span<const std::uint8_t> bytes,
                                            const std::map<std::string, std::vector<std::int64_t>>& shapes);

}  // namespace holdfast
