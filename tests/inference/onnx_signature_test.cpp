// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/onnx_signature.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "holdfast/core/error.hpp"
#include "inference/model_bytes.hpp"
#include "onnx_shapes.hpp"

namespace holdfast {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

TEST(OnnxSignature, TellsInputsAndOutputs) {
  const OnnxSignature fixed = read_onnx_signature(test::model_bytes("two_outputs"), "m");
  ASSERT_EQ(fixed.inputs.size(), 1U);
  EXPECT_EQ(fixed.inputs[0].name, "image");
  EXPECT_EQ(fixed.inputs[0].element_type, 1);
  EXPECT_THAT(fixed.inputs[0].shape, ElementsAre(1, 3, 12, 16));
  ASSERT_EQ(fixed.outputs.size(), 2U);
  EXPECT_EQ(fixed.outputs[1].name, "shares");
  EXPECT_FALSE(fixed.has_half_precision);
  EXPECT_EQ(read_onnx_signature(test::model_bytes("any_size"), "m").inputs[0].shape_text(), "1x3x?x?");
  EXPECT_TRUE(read_onnx_signature(test::model_bytes("half"), "m").has_half_precision);
}

TEST(OnnxSignature, ShapesOfInputsCanBeWrittenInPlaceOfTheirOwn) {
  const std::vector<std::uint8_t> bytes = test::model_bytes("any_size");
  const OnnxSignature before = read_onnx_signature(bytes, "m");
  const std::string name = before.inputs[0].name;
  const std::vector<std::uint8_t> written = with_input_shapes(bytes, {{name, {1, 3, 20, 300}}, {"absent", {7}}});
  const OnnxSignature after = read_onnx_signature(written, "m");
  ASSERT_EQ(after.inputs.size(), 1U);
  EXPECT_EQ(after.inputs[0].name, name);
  EXPECT_EQ(after.inputs[0].element_type, before.inputs[0].element_type);
  EXPECT_THAT(after.inputs[0].shape, ElementsAre(1, 3, 20, 300));
  EXPECT_EQ(after.outputs[0].shape, before.outputs[0].shape);
  // What is written once more is the same, and so is a model of which nothing is changed.
  EXPECT_EQ(with_input_shapes(written, {{name, {1, 3, 20, 300}}}), written);
  EXPECT_EQ(with_input_shapes(bytes, {}), bytes);
}

std::string signature_error(const std::vector<std::uint8_t>& bytes) {
  try {
    read_onnx_signature(bytes, "m");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(OnnxSignature, RefusesALayerWhoseInputNothingProvides) {
  std::vector<std::uint8_t> bytes = test::model_bytes("labels");
  bytes[33] = 'b';  // the first layer provides 'scobes'
  EXPECT_THAT(signature_error(bytes),
              AllOf(HasSubstr("m: has a layer 'labels_node' (ArgMax) that reads 'scores', which no"),
                    HasSubstr("export it again")));
}

TEST(OnnxSignature, RefusesALayerWithoutInput) {
  std::vector<std::uint8_t> bytes = test::model_bytes("labels");
  ASSERT_EQ(bytes[98], 0x0a);
  bytes[98] = 0x1a;  // what was the input is a name now
  EXPECT_THAT(signature_error(bytes), HasSubstr("(ArgMax) without an input"));
}

TEST(OnnxSignature, RefusesDimensionsLargerThanTheData) {
  std::vector<std::uint8_t> bytes = test::model_bytes("one_channel");
  bytes[106] = 0x7f;
  EXPECT_THAT(signature_error(bytes), HasSubstr("has a tensor 'weight' of 127x3x1x1, but data for 3 elements"));
  bytes[106] = 0;
  EXPECT_EQ(signature_error(bytes), "no error") << "nothing is read of an empty tensor";
}

/// Packed numbers of their own type instead of raw bytes.
TEST(OnnxSignature, CountsTypedData) {
  std::vector<std::uint8_t> bytes = test::model_bytes("one_channel");
  const std::vector<std::uint8_t> raw = {0x4a, 12, 0, 0, 0, 0x41};
  const auto found = std::search(bytes.begin(), bytes.end(), raw.begin(), raw.end());
  ASSERT_NE(found, bytes.end());
  *found = 0x22;  // float_data
  EXPECT_EQ(signature_error(bytes), "no error");
  bytes[106] = 2;
  EXPECT_THAT(signature_error(bytes), HasSubstr("of 2x3x1x1, but data for 3 elements"));
  *found = 0x2a;  // int32_data, which OpenCV does not read for floats
  EXPECT_THAT(signature_error(bytes), HasSubstr("but data for 0 elements"));
}

TEST(OnnxSignature, EveryTruncationAndAnyRubbishIsAnErrorOrShorter) {
  const std::vector<std::uint8_t> whole = test::model_bytes("channels_last");
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
