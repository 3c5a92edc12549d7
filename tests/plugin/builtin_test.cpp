// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/builtin.hpp"

#include <gtest/gtest.h>

#include "holdfast/interfaces/loop_detector.hpp"
#include "holdfast/interfaces/segmenter.hpp"

namespace holdfast {
namespace {

TEST(BuiltinPlugins, HoldTheNullObjects) {
  Registry registry;
  register_builtin_plugins(registry);
  EXPECT_TRUE(registry.create<Segmenter>("none", {}, {})->classes().empty());
  EXPECT_TRUE(registry.create<LoopDetector>("none", {}, {})->query({}, 3).empty());
  EXPECT_EQ(registry.find("segmenter", "none")->origin, "built in");
}

}  // namespace
}  // namespace holdfast
