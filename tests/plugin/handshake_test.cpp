// SPDX-License-Identifier: BSD-3-Clause
// Plugins that were really built in another way are refused, with both sides named, before anything of them runs.
#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/plugin/abi.hpp"
#include "holdfast/plugin/loader.hpp"

namespace holdfast {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string file_of(const std::string& name) {
  return std::string(TEST_PLUGIN_FOLDER) + "/libtest_plugin_" + name + ".so";
}

std::string refusal(const std::string& file) {
  Registry registry;
  try {
    load_plugin(registry, file);
  } catch (const PluginError& error) {
    EXPECT_TRUE(registry.kinds().empty());
    return error.what();
  }
  return "loaded";
}

/// That the plugin is refused because of `what`, where ours is known and theirs is told.
void expect_refused(const std::string& name, const std::string& what, long ours, const std::string& theirs) {
  EXPECT_THAT(refusal(file_of(name)),
              AllOf(HasSubstr(file_of(name) + "' does not fit this program: "),
                    HasSubstr(what + ": program " + std::to_string(ours)), HasSubstr(", plugin " + theirs)));
}

TEST(Handshake, OtherVersions) {
  EXPECT_THAT(refusal(file_of("other_holdfast")),
              HasSubstr("Holdfast version: program " HOLDFAST_VERSION ", plugin 9.1.0"));
  EXPECT_THAT(refusal(file_of("other_opencv")), AllOf(HasSubstr("OpenCV version: program "), HasSubstr("plugin 3.")));
  EXPECT_THAT(refusal(file_of("other_eigen")), AllOf(HasSubstr("Eigen version: program "), HasSubstr(".99")));
}

TEST(Handshake, OtherStandard) { expect_refused("cpp23", "C++ standard", __cplusplus, "202"); }

TEST(Handshake, OtherEigen) {
  expect_refused("eigen_alignment", "Eigen alignment", EIGEN_MAX_ALIGN_BYTES, "64");
  expect_refused("eigen_structs", "Eigen alignment inside structs", alignof(Eigen::Vector4d), "8");
  expect_refused("eigen_row_major", "EIGEN_DEFAULT_TO_ROW_MAJOR", 0, "1");
  expect_refused("eigen_index", "size of Eigen's index", sizeof(Eigen::Index), "4");
#if defined(HOLDFAST_TEST_AVX)
  expect_refused("avx", "Eigen alignment", EIGEN_MAX_ALIGN_BYTES, "32");
#endif
}

TEST(Handshake, OtherStrings) {
  // It cannot even be loaded: its symbols are called otherwise. The reason must come first.
  expect_refused("old_strings", "_GLIBCXX_USE_CXX11_ABI", 1, "0");
}

TEST(Handshake, OtherContainers) { expect_refused("debug_containers", "_GLIBCXX_DEBUG", 0, "1"); }

TEST(Handshake, OtherCompilerAbi) {
#if defined(HOLDFAST_TEST_COMPILER_ABI)
  expect_refused("compiler_abi", "compiler ABI (__GXX_ABI_VERSION)", __GXX_ABI_VERSION, "1011 (GCC ");
#else
  GTEST_SKIP() << "the compiler has one ABI only";
#endif
}

TEST(Handshake, OtherSanitizers) {
#if defined(HOLDFAST_TEST_SANITIZER)
  EXPECT_THAT(refusal(file_of("sanitizer")), HasSubstr("sanitizers: program none, plugin thread"));
#else
  GTEST_SKIP() << "this build has sanitizers itself";
#endif
}

TEST(Handshake, AssertionsAndOptimisationMakeNoDifference) {
  Registry registry;
  load_plugin(registry, file_of("with_assertions"));
  EXPECT_EQ(registry.create<Segmenter>("good", {{"dilate", std::int64_t{2}}}, {})->classes().size(), 2U);
}

TEST(Handshake, DamagedLibrariesAreRefused) {
  std::ostringstream whole;
  whole << std::ifstream(file_of("good"), std::ios::binary).rdbuf();
  const std::string bytes = whole.str();
  const std::string file = testing::TempDir() + "holdfast_damaged_plugin.so";
  ASSERT_GT(bytes.size(), 30000U);
  for (const std::size_t size : {0, 40, 1000, 20000}) {
    std::ofstream(file, std::ios::binary) << bytes.substr(0, size);
    EXPECT_THAT(refusal(file), AllOf(HasSubstr(file), HasSubstr("cannot be loaded"))) << size;
  }
  std::remove(file.c_str());
}

}  // namespace
}  // namespace holdfast
