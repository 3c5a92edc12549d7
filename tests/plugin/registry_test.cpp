// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/registry.hpp"

#include <gmock/gmock.h>

#include "holdfast/interfaces/segmenter.hpp"

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

}  // namespace
}  // namespace holdfast
