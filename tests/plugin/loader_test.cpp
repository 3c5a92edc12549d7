// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/loader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "holdfast/plugin/abi.hpp"
#include "plugin/number.hpp"

namespace holdfast {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

const fs::path folder = HOLDFAST_TEST_PLUGINS;

std::string refusal(Registry& registry, const std::string& name, const std::vector<fs::path>& search_first = {folder}) {
  try {
    load_plugin(registry, name, search_first);
  } catch (const PluginError& error) {
    return error.what();
  }
  return "";
}
std::string refusal(const std::string& name) {
  Registry registry;
  return refusal(registry, name);
}

TEST(PluginLoader, LoadsAPluginThatMakesModules) {
  Registry registry;
  const fs::path file = load_plugin(registry, (folder / "libtest_good_plugin.so").string());
  EXPECT_EQ(file, folder / "libtest_good_plugin.so");
  const ModuleEntry* entry = registry.find("number", "given");
  ASSERT_NE(entry, nullptr);
  EXPECT_EQ(entry->origin, file.string());
  EXPECT_EQ(entry->parameters.at(0).name, "number");
  CreationContext context;
  context.seed = 40;
  EXPECT_EQ(registry.create<test::Number>("given", {{"number", 2.25}}, context)->number(), 42.25);
  EXPECT_EQ(registry.create<test::Number>("given", {}, context)->number(), 41.5);
  EXPECT_EQ(registry.origin(), "built in");  // for what is registered next
}

TEST(PluginLoader, ServesManyRegistries) {
  Registry first, second;
  load_plugin(first, "test_good_plugin", {folder});
  load_plugin(second, "test_good_plugin", {folder});
  EXPECT_NE(second.find("number", "given"), nullptr);
}

TEST(PluginLoader, FindsNamesInFolders) {
  for (const char* name : {"test_good_plugin", "test_good_plugin.so", "libtest_good_plugin.so"}) {
    Registry registry;
    EXPECT_EQ(load_plugin(registry, name, {"/nowhere", folder}), folder / "libtest_good_plugin.so");
  }
  Registry registry;
  setenv("HOLDFAST_PLUGIN_PATH", ("/nowhere:" + folder.string()).c_str(), 1);
  EXPECT_EQ(refusal(registry, "test_good_plugin", {}), "");
  unsetenv("HOLDFAST_PLUGIN_PATH");
}

TEST(PluginLoader, TellsWhereItSearched) {
  setenv("HOLDFAST_PLUGIN_PATH", "/from/environment", 1);
  Registry registry;
  EXPECT_THAT(refusal(registry, "libnobody.so", {"/first"}),
              AllOf(HasSubstr("plugin 'libnobody.so' cannot be found; searched: /first, /from/environment, "),
                    HasSubstr("holdfast/plugins")));
  unsetenv("HOLDFAST_PLUGIN_PATH");
  EXPECT_EQ(refusal("/nowhere/x.so"), "plugin '/nowhere/x.so' cannot be loaded: there is no such file");
}

TEST(PluginLoader, RefusesAnotherAbiBeforeCallingIt) {
  EXPECT_THAT(
      refusal("test_other_abi_plugin"),
      AllOf(HasSubstr("does not fit this program"), HasSubstr("Holdfast version: program "), HasSubstr("plugin 9"),
            HasSubstr("Eigen alignment: program " + std::to_string(EIGEN_MAX_ALIGN_BYTES) + ", plugin " +
                      std::to_string(2 * EIGEN_MAX_ALIGN_BYTES))));
}

TEST(PluginLoader, RefusesWhatIsNoPlugin) {
  EXPECT_THAT(refusal("test_no_record_plugin"), HasSubstr("is no Holdfast plugin: it has no ABI record"));
  EXPECT_THAT(refusal("test_no_entry_plugin"), HasSubstr("has no entry function holdfast_register_plugin"));
  const fs::path text = fs::temp_directory_path() / ("holdfast_not_a_library_" + std::to_string(getpid()) + ".so");
  std::ofstream(text) << "not a library";
  EXPECT_THAT(refusal(text.string()), AllOf(HasSubstr(text.string()), HasSubstr("cannot be loaded: ")));
  fs::remove(text);
}

TEST(PluginLoader, PassesOnWhatRegistrationSays) {
  EXPECT_THAT(refusal("test_throwing_plugin"), HasSubstr("failed to register its modules: no licence"));
  Registry registry;
  load_plugin(registry, "test_good_plugin", {folder});
  EXPECT_THAT(
      refusal(registry, "test_good_plugin"),
      AllOf(HasSubstr("number module 'given'"), HasSubstr("the name is taken"), HasSubstr("libtest_good_plugin.so")));
  EXPECT_EQ(registry.origin(), "built in");
}

TEST(AbiRecord, NamesEveryDifference) {
  const AbiRecord ours = compiled_abi();
  EXPECT_TRUE(abi_differences(ours, ours).empty());
  AbiRecord theirs = ours;
  theirs.cpp_standard += 1, theirs.opencv_version += 1, theirs.eigen_version += 1, theirs.compiler_abi += 1;
  theirs.new_string_abi ^= 1;
  EXPECT_EQ(abi_differences(ours, theirs).size(), 5U);
  theirs = ours;
  theirs.record_size += 8;
  EXPECT_EQ(abi_differences(ours, theirs).size(), 1U);
  theirs = ours;
  theirs.magic = 0;
  EXPECT_EQ(abi_differences(ours, theirs).size(), 1U);
}

}  // namespace
}  // namespace holdfast
