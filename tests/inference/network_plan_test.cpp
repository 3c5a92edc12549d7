// SPDX-License-Identifier: BSD-3-Clause
#include "network_plan.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "holdfast/core/error.hpp"
#include "inference/model_bytes.hpp"

namespace holdfast {
namespace {

using testing::HasSubstr;

class PlanTest : public testing::Test {
 protected:
  OnnxGraph graph = read_onnx_graph(test::model_bytes("every_layer"), "net.onnx");

  NetworkPlan plan(std::vector<std::int64_t> shape = {1, 3, 12, 16}) const {
    return plan_network(graph, {{"image", std::move(shape)}}, {"scores"}, "net.onnx");
  }
  std::string error(std::vector<std::int64_t> shape = {1, 3, 12, 16}) const {
    try {
      plan(std::move(shape));
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "no error";
    return "";
  }
  OnnxNode& node(const std::string& name) {
    for (OnnxNode& candidate : graph.nodes)
      if (candidate.name == name + "_node") return candidate;
    throw std::out_of_range(name);
  }
  void replace_everywhere(const std::string& tensor, const std::string& other) {
    for (OnnxNode& candidate : graph.nodes)
      std::replace(candidate.inputs.begin(), candidate.inputs.end(), tensor, other);
  }
};

TEST_F(PlanTest, TheGraphIsReadAsItIs) {
  EXPECT_EQ(graph.opset, 10);
  EXPECT_EQ(graph.nodes.size(), 19U);
  EXPECT_EQ(node("deep").attributes.at("strides").integers, (std::vector<std::int64_t>{2, 2}));
  EXPECT_EQ(node("inner").attributes.at("group").integer, 8);
  EXPECT_FLOAT_EQ(node("deep_relu").attributes.at("alpha").number, 0.2F);
  EXPECT_EQ(graph.weights.at("inner_weight").shape, (std::vector<std::int64_t>{8, 1, 3, 3}));
  EXPECT_EQ(graph.weights.at("inner_weight").numbers.size(), 72U);
}

TEST_F(PlanTest, SumsAndActivationsBelongToConvolutions) {
  const NetworkPlan result = plan();
  EXPECT_EQ(result.layers.size(), 12U);
  std::size_t sums = 0;
  for (const PlannedLayer& layer : result.layers) {
    EXPECT_NE(layer.kind, LayerKind::activation) << layer.name;
    EXPECT_NE(layer.kind, LayerKind::add) << layer.name;
    sums += layer.added ? 1 : 0;
  }
  EXPECT_EQ(sums, 1U);
  EXPECT_EQ(result.tensors[result.outputs[0]], (PlaneShape{1, 3, 12, 16}));
}

TEST_F(PlanTest, WhatIsReadTwiceIsNotJoined) {
  // The last convolution reads the sums without their activation: these stay two layers.
  replace_everywhere("top_relu", "top");
  node("wide_sigmoid").inputs = {"wide"};
  node("top").inputs[0] = "wide";
  node("last").inputs = {"skip", "top"};
  EXPECT_EQ(plan().layers.size(), 12U);  // nothing needs the activations any more
  node("last").inputs = {"top_relu", "top"};
  node("top_relu").inputs = {"top"};
  graph.weights["scores_weight"].shape = {3, 12, 1, 1};
  graph.weights["scores_weight"].numbers.resize(36);
  const NetworkPlan result = plan();
  EXPECT_TRUE(std::any_of(result.layers.begin(), result.layers.end(),
                          [](const PlannedLayer& layer) { return layer.kind == LayerKind::activation; }));
}

TEST_F(PlanTest, UnknownOperatorsAndAttributesAreRefused) {
  OnnxNode& deep = node("deep_relu");
  deep.kind = "Sorcery";
  EXPECT_THAT(error(), HasSubstr("net.onnx: has a layer 'deep_relu_node' (Sorcery) that the engine onednn does not"));
  deep.kind = "LeakyRelu";
  deep.domain = "com.example";
  EXPECT_THAT(error(), HasSubstr("of the domain 'com.example'"));
  deep.domain = "";
  deep.attributes["spell"] = {};
  EXPECT_THAT(error(), HasSubstr("with an attribute 'spell'"));
}

TEST_F(PlanTest, WhatDoesNotAgreeIsRefused) {
  EXPECT_THAT(error({1, 4, 12, 16}), HasSubstr("for an input of 1x4x12x16, which do not agree"));
  EXPECT_THAT(error({1, 3, 12}), HasSubstr("expects four dimensions"));
  EXPECT_THAT(error({1, 3, 12, 18}), HasSubstr("check width and height"));
  EXPECT_THAT(error({1, 3, 100000, 100000}), HasSubstr("check width and height"));
  EXPECT_THAT(error({1, 3, 0, 16}), HasSubstr("check width and height"));
  node("inner").attributes["group"].integer = 0;
  EXPECT_THAT(error(), HasSubstr("in 0 groups"));
  node("inner").attributes["group"].integer = -1;
  EXPECT_THAT(error(), HasSubstr("in -1 groups"));
  node("inner").attributes["group"].integer = 8;
  node("inner").attributes["strides"].integers = {0, 1};
  EXPECT_THAT(error(), HasSubstr("with strides 0x1; expected 2 numbers from 1"));
  node("inner").attributes["strides"].integers = {1};
  EXPECT_THAT(error(), HasSubstr("with strides 1; expected 2 numbers from 1"));
  node("inner").attributes["strides"].integers = {1, 1};
  node("inner").attributes["dilations"].integers = {9, 9};
  EXPECT_THAT(error(), HasSubstr("whose window of 19 is larger than its input of 1x8x12x16"));
  node("inner").attributes["dilations"].integers = {1, 1};
  graph.weights["inner_bias"].shape = {7};
  EXPECT_THAT(error(), HasSubstr("with a bias of 7; expected 8"));
  graph.weights.erase("inner_bias");
  EXPECT_THAT(error(), HasSubstr("reads 'inner_bias'; expected weights of the file, of type float32"));
}

TEST_F(PlanTest, NewerFilesKeepTheLimitsOfClipAsTensors) {
  node("inner_clip").attributes.clear();
  node("inner_clip").inputs = {"inner", "", "six"};
  graph.weights["six"] = {1, {}, {6.5F}, {}};
  for (const NetworkPlan result = plan(); const PlannedLayer& layer : result.layers)
    if (layer.activation == Activation::clip) {
      EXPECT_LT(layer.first_parameter, -1e38F);
      EXPECT_EQ(layer.second_parameter, 6.5F);
    }
  graph.weights["six"].numbers = {1.0F, 2.0F};
  EXPECT_THAT(error(), HasSubstr("expected one number"));
}

TEST_F(PlanTest, ThereIsAnAnswerForEachMissingPart) {
  node("joined").attributes["axis"].integer = 9;
  EXPECT_THAT(error(), HasSubstr("with axis 9"));
  node("joined").attributes["axis"].integer = 1;
  node("half").attributes.erase("kernel_shape");
  EXPECT_THAT(error(), HasSubstr("without kernel_shape"));
  node("half").attributes["kernel_shape"].integers = {2, 2};
  node("half").attributes["ceil_mode"].integer = 1;
  EXPECT_THAT(error(), HasSubstr("ceil_mode"));
  node("half").attributes.erase("ceil_mode");
  node("up").attributes["output_padding"].integers = {2, 2};
  EXPECT_THAT(error(), HasSubstr("more output_padding than pads"));
  node("up").attributes["output_padding"].integers = {1, 1};
  node("skip").inputs[1] = "up_bias";
  EXPECT_THAT(error(), HasSubstr("no tensor 'up_bias' that is computed"));
}

TEST_F(PlanTest, NoPartOfAFileIsReadBeyondItsEnd) {
  const std::vector<std::uint8_t> bytes = test::model_bytes("logits");
  EXPECT_NO_THROW(read_onnx_graph(bytes, "net.onnx"));
  // Each prefix is refused by one reader or the other; none is read beyond its end.
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    try {
      read_onnx_graph(std::span(bytes).first(size), "net.onnx");
    } catch (const InputError&) {
    }
  }
}

}  // namespace
}  // namespace holdfast
