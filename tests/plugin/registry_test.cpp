// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/registry.hpp"

#include <gmock/gmock.h>

#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/plugin/module_check.hpp"

namespace holdfast {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

void add_segmenter(Registry& registry, const std::string& name) {
  registry.add<Segmenter, NoSettings>(
      {.name = name}, [](const NoSettings&, const CreationContext&) { return std::make_unique<NullSegmenter>(); });
}

template <class Function>
std::string plugin_error(Function function) {
  try {
    function();
  } catch (const PluginError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Registry, ListsByKindAndName) {
  Registry registry;
  add_segmenter(registry, "unet");
  add_segmenter(registry, "none");
  EXPECT_THAT(registry.kinds(), ElementsAre("segmenter"));
  EXPECT_THAT(registry.names("segmenter"), ElementsAre("none", "unet"));
  EXPECT_EQ(registry.find("segmenter", "unt"), nullptr);
  EXPECT_EQ(registry.find("optimizer", "unet"), nullptr);
}

TEST(Registry, NamesBothSidesOfANameClash) {
  Registry registry;
  add_segmenter(registry, "unet");
  registry.set_origin("/opt/libmine.so");
  EXPECT_THAT(plugin_error([&] { add_segmenter(registry, "unet"); }),
              AllOf(HasSubstr("segmenter module 'unet'"), HasSubstr("/opt/libmine.so"), HasSubstr("built in")));
}

TEST(Registry, SuggestsAName) {
  Registry registry;
  add_segmenter(registry, "unet");
  EXPECT_EQ(plugin_error([&] { registry.create<Segmenter>("uent", {}, {}); }),
            "no segmenter module is called 'uent'; did you mean 'unet'?");
}

TEST(Registry, SaysWhatIsNotInThisBuild) {
  Registry registry;
  add_segmenter(registry, "unet");
  add_segmenter(registry, "python");
  registry.add_left_out("segmenter", "onnx", "HOLDFAST_PLUGIN_ONNX");
  registry.add_unusable("segmenter", "python", "its library is not there");
  EXPECT_EQ(registry.absence("segmenter", "unet"), "");
  EXPECT_EQ(registry.absence("segmenter", "nothing"), "");
  EXPECT_EQ(registry.absence("segmenter", "python"), "its library is not there");
  EXPECT_EQ(registry.absence("segmenter", "onnx"),
            "it was left out of this build; configure Holdfast with -DHOLDFAST_PLUGIN_ONNX=ON");
  EXPECT_EQ(registry.left_out("segmenter"), std::vector<std::string>{"onnx"});
  // A configuration that chooses it is wrong, at the place of the name.
  std::vector<Diagnostic> diagnostics;
  find_module(registry, "segmenter", "python", {"c.yaml", 3, 12}, diagnostics);
  ASSERT_EQ(diagnostics.size(), 1U);
  EXPECT_EQ(diagnostics[0].to_string(),
            "c.yaml:3:12: the segmenter module 'python' cannot be used: its library is not there");
}

}  // namespace
}  // namespace holdfast
