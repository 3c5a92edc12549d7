// SPDX-License-Identifier: BSD-3-Clause
// A program that does not find the library `holdfast_python`, because it was not built or lies elsewhere.
#include <gmock/gmock.h>

#include <cstdlib>

#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/plugin/registry.hpp"

extern "C" void holdfast_register_plugin_python(holdfast::Registry&);

namespace holdfast {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(WithoutPython, TheErrorSaysWhatToInstall) {
  unsetenv("HOLDFAST_PLUGIN_PATH");
  Registry registry;
  holdfast_register_plugin_python(registry);
  ASSERT_NE(registry.find("segmenter", "python"), nullptr) << "the reference must not depend on the build";
  try {
    registry.create<Segmenter>("python", {{"file", std::string("segmenter.py")}}, {});
    FAIL() << "no error";
  } catch (const PluginError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("segmenter 'python'"), HasSubstr("holdfast_python"),
                                    HasSubstr("searched: "), HasSubstr("python3-dev"), HasSubstr("pybind11-dev"),
                                    HasSubstr("-DHOLDFAST_PYTHON=ON"), HasSubstr("HOLDFAST_PLUGIN_PATH")));
  }
}

}  // namespace
}  // namespace holdfast
