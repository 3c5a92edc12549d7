// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/loader.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>

#include "holdfast/core/version.hpp"
#include "holdfast/interfaces/segmenter.hpp"

namespace holdfast {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::filesystem::path folder = TEST_PLUGIN_FOLDER;

std::string file_of(const std::string& name) { return (folder / ("libtest_plugin_" + name + ".so")).string(); }

std::string refusal(const std::string& name_or_path, const std::vector<std::filesystem::path>& search = {}) {
  Registry registry;
  try {
    load_plugin(registry, name_or_path, search);
  } catch (const PluginError& error) {
    EXPECT_TRUE(registry.kinds().empty()) << "a refused plugin must not have registered anything";
    return error.what();
  }
  return "loaded";
}

TEST(Loader, LoadsAndCreates) {
  Registry registry;
  load_plugin(registry, file_of("good"));
  const ModuleEntry* entry = registry.find("segmenter", "good");
  ASSERT_NE(entry, nullptr);
  EXPECT_EQ(entry->origin, file_of("good"));
  ASSERT_EQ(entry->parameters.size(), 1U);
  EXPECT_EQ(entry->parameters[0].name, "dilate");
  const auto segmenter = registry.create<Segmenter>("good", {{"dilate", std::int64_t{3}}}, {});
  EXPECT_EQ(segmenter->classes().size(), 3U);
  EXPECT_EQ(registry.origin(), "built in") << "what is registered next is not of the plugin";
}

TEST(Loader, FindsByNameInTheGivenFolders) {
  for (const std::string name : {"test_plugin_good", "libtest_plugin_good", "test_plugin_good.so"}) {
    Registry registry;
    load_plugin(registry, name, {"/nowhere", folder});
    EXPECT_NE(registry.find("segmenter", "good"), nullptr) << name;
  }
}

TEST(Loader, FindsByNameInTheEnvironment) {
  setenv("HOLDFAST_PLUGIN_PATH", ("/nowhere:" + folder.string()).c_str(), 1);
  Registry registry;
  load_plugin(registry, "test_plugin_good");
  unsetenv("HOLDFAST_PLUGIN_PATH");
  EXPECT_NE(registry.find("segmenter", "good"), nullptr);
}

TEST(Loader, SearchesInTheDocumentedOrder) {
  setenv("HOLDFAST_PLUGIN_PATH", "/second::/third", 1);
  const auto folders = plugin_search_path({"/first"});
  unsetenv("HOLDFAST_PLUGIN_PATH");
  ASSERT_EQ(folders.size(), 4U);
  EXPECT_EQ(folders[0], "/first");
  EXPECT_EQ(folders[1], "/second");
  EXPECT_EQ(folders[2], "/third");
  EXPECT_TRUE(folders[3].string().ends_with("holdfast/plugins"));
}

TEST(Loader, NamesTheSearchedFoldersOfAMissingPlugin) {
  EXPECT_THAT(refusal("libabsent.so", {"/nowhere", "/elsewhere"}),
              AllOf(HasSubstr("'libabsent.so' cannot be found"), HasSubstr("searched: /nowhere, /elsewhere"),
                    HasSubstr("HOLDFAST_PLUGIN_PATH")));
  EXPECT_THAT(refusal("/nowhere/libabsent.so"),
              HasSubstr("'/nowhere/libabsent.so' cannot be loaded: there is no such"));
}

TEST(Loader, RefusesAFileThatIsNoLibrary) {
  const std::filesystem::path text = std::filesystem::path(testing::TempDir()) / "holdfast_no_library.so";
  std::ofstream(text) << "text";
  EXPECT_THAT(refusal(text.string()), AllOf(HasSubstr(text.string()), HasSubstr("cannot be loaded")));
  std::filesystem::remove(text);
}

TEST(Loader, RefusesAMismatchNamingBothSides) {
  EXPECT_THAT(refusal(file_of("stranger")),
              AllOf(HasSubstr(file_of("stranger") + "' does not fit this program"),
                    HasSubstr("Holdfast version: program " HOLDFAST_VERSION ", plugin 9"),
                    HasSubstr("Eigen alignment: program " + std::to_string(EIGEN_MAX_ALIGN_BYTES) + ", plugin 1024")));
}

TEST(Loader, RefusesWhatIsNoPlugin) {
  EXPECT_THAT(refusal(file_of("no_entry")), HasSubstr("has no entry function holdfast_register_plugin"));
  EXPECT_THAT(refusal(file_of("no_record")), HasSubstr("it has no ABI record holdfast_plugin_abi"));
  EXPECT_THAT(refusal(file_of("not_ours")), HasSubstr("does not begin with Holdfast's mark"));
}

TEST(Loader, PassesOnWhatThePluginThrows) {
  EXPECT_THAT(refusal(file_of("thrower")),
              AllOf(HasSubstr(file_of("thrower")), HasSubstr("failed to register its modules: no licence file")));
}

TEST(Loader, LoadsAPluginIntoARegistryOnce) {
  Registry registry;
  load_plugin(registry, file_of("good"));
  load_plugin(registry, file_of("good"));
  EXPECT_EQ(registry.of_kind("segmenter").size(), 1U);
}

TEST(Loader, ReturnsTheFileItFound) {
  Registry registry;
  EXPECT_EQ(load_plugin(registry, "test_plugin_good", {folder}), file_of("good"));
}

}  // namespace
}  // namespace holdfast
