// SPDX-License-Identifier: BSD-3-Clause
// The declarations of an ONNX file, which are checked before OpenCV reads it.
#include "holdfast/inference/onnx_signature.hpp"
#include "fuzz.hpp"

using namespace holdfast;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::accepts([&] {
    const OnnxSignature signature = read_onnx_signature({data, size}, "network.onnx");
    fuzz::require(!signature.inputs.empty() && !signature.outputs.empty(), "inputs and outputs are declared");
    for (const OnnxTensor& tensor : signature.inputs) tensor.shape_text();
  });
  return 0;
}
