// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace holdfast::test {

/// Scripts for node with packages of npm, which are installed on first use into a folder of the build.
class NpmTools {
 public:
  /// `folder`: HOLDFAST_TEST_NPM_FOLDER; `packages`: such as "ws@8.23.0".
  NpmTools(std::filesystem::path folder, const std::vector<std::string>& packages) : folder_(std::move(folder)) {
    std::filesystem::create_directories(folder_);
    const std::filesystem::path output = std::filesystem::temp_directory_path() / ("npm_" + std::to_string(getpid()));
    std::string missing;
    for (const std::string& package : packages)
      if (!std::filesystem::exists(folder_ / "node_modules" / package.substr(0, package.rfind('@'))))
        missing += " " + package;
    if (!run("node --version", output))
      trouble_ = "there is no node";
    else if (!missing.empty() && !run("flock . npm install --no-audit --no-fund --prefix ." + missing, output))
      trouble_ = "npm cannot install" + missing + "; is there npm, and a network?";
    std::filesystem::remove(output);
  }

  /// Why scripts cannot run; empty if they can.
  const std::string& trouble() const { return trouble_; }

  /// Runs a command in the folder, for at most two minutes. Its output goes to a file; returns it, or nothing if the
  /// command fails.
  std::optional<std::string> run(const std::string& command, const std::filesystem::path& output) const {
    const std::string all =
        "cd '" + folder_.string() + "' && timeout 120 " + command + " >'" + output.string() + "' 2>&1";
    const bool is_done = std::system(all.c_str()) == 0;
    std::ostringstream text;
    text << std::ifstream(output).rdbuf();
    if (!is_done) return std::nullopt;
    return text.str();
  }

 private:
  std::filesystem::path folder_;
  std::string trouble_;
};

}  // namespace holdfast::test
