// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/onnx_signature.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

using testing::ElementsAre;
namespace fs = std::filesystem;

std::vector<std::uint8_t> bytes_of(const std::string& name) {
  std::ifstream stream(fs::path(HOLDFAST_TEST_MODELS) / (name + ".onnx"), std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

TEST(OnnxSignature, TellsInputsAndOutputs) {
  const OnnxSignature fixed = read_onnx_signature(bytes_of("two_outputs"), "m");
  ASSERT_EQ(fixed.inputs.size(), 1U);
  EXPECT_EQ(fixed.inputs[0].name, "image");
  EXPECT_EQ(fixed.inputs[0].element_type, 1);
  EXPECT_THAT(fixed.inputs[0].shape, ElementsAre(1, 3, 12, 16));
  ASSERT_EQ(fixed.outputs.size(), 2U);
  EXPECT_EQ(fixed.outputs[1].name, "shares");
  EXPECT_FALSE(fixed.has_half_precision);
  EXPECT_EQ(read_onnx_signature(bytes_of("any_size"), "m").inputs[0].shape_text(), "1x3x?x?");
  EXPECT_TRUE(read_onnx_signature(bytes_of("half"), "m").has_half_precision);
}

TEST(OnnxSignature, EveryTruncationAndAnyRubbishIsAnErrorOrShorter) {
  const std::vector<std::uint8_t> whole = bytes_of("channels_last");
  for (std::size_t size = 0; size < whole.size() - 20; ++size)
    EXPECT_THROW(read_onnx_signature(std::span(whole).first(size), "m"), InputError) << size;
  for (std::size_t at = 0; at < whole.size(); ++at)
    for (const std::uint8_t value : {0, 1, 0x7f, 0x80, 0xff}) {
      std::vector<std::uint8_t> damaged = whole;
      damaged[at] = value;
      try {
        read_onnx_signature(damaged, "m");
      } catch (const InputError&) {
      }
    }
}

}  // namespace
}  // namespace holdfast
