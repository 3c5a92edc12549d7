// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace holdfast::test {

/// The bytes of models/NAME.onnx.
inline std::vector<std::uint8_t> model_bytes(const std::string& name) {
  std::ifstream stream(std::string(HOLDFAST_TEST_MODELS) + "/" + name + ".onnx", std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace holdfast::test
