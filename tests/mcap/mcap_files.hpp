// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "support/npm_tools.hpp"

namespace holdfast::test {

/// A folder for the files of a test, and the reader of npm.
class McapFilesTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / ("holdfast_mcap_files_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static const NpmTools& tools() {
    static const NpmTools the_tools(
        HOLDFAST_TEST_NPM_FOLDER,
        {"@mcap/core@2.2.2", "@foxglove/rosmsg@5.0.5", "@foxglove/rosmsg2-serialization@3.1.0",
         "@foxglove/wasm-zstd@1.0.1", "@foxglove/schemas@2.1.0", "ajv@8.20.0"});
    return the_tools;
  }
  /// What read_mcap.mjs finds in a file.
  nlohmann::json read_by_others(const std::filesystem::path& file) const {
    const std::string command = "node '" HOLDFAST_TEST_READER "' '" + file.string() + "'";
    const std::optional<std::string> said = tools().run(command, folder_ / "output");
    EXPECT_TRUE(said) << "the reader failed";
    return said ? nlohmann::json::parse(*said) : nlohmann::json();
  }

  std::filesystem::path folder_;
};

}  // namespace holdfast::test
