// SPDX-License-Identifier: BSD-3-Clause
// A disk that refuses one write, rename, sync or close: the command says so, and every file is whole or absent. Each
// command meets a sample of the faults; HOLDFAST_WRITE_FAULTS sets how many of them, and `all` tries every one. And a
// disk that refuses a read, which is not the end of the file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "cli/program.hpp"

namespace holdfast {
namespace {

namespace fs = std::filesystem;
using Files = std::map<std::string, std::string>;  // content by path below the folder

Files files_below(const fs::path& folder) {
  Files files;
  if (!fs::exists(folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files[fs::relative(entry.path(), folder).string()] = test::content(entry.path());
  return files;
}

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// Whether these are the poses that a run writes as it goes, whole lines of them, and says so: where they cannot be
/// replaced by the corrected ones, they stay.
bool is_journal(const std::string& name, const std::string& content) {
  if (name != "trajectory.txt" || !content.starts_with("# The run has not come to its end")) return false;
  std::istringstream stream(content);
  std::string line;
  while (std::getline(stream, line))
    if (!line.starts_with('#') && std::count(line.begin(), line.end(), ' ') != 7) return false;
  return content.back() == '\n';
}

/// Whether a file that holds times of this run is whole.
bool is_whole(const std::string& name, const std::string& content) {
  if (ends_with(name, ".json")) return nlohmann::json::accept(content);
  if (ends_with(name, ".html")) return ends_with(content, "</html>\n");
  if (ends_with(name, ".hfm") || ends_with(name, ".ply"))
    return true;  // compared with those of the run without a fault
  return !content.empty() && content.back() == '\n';
}

class WriteFaultsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    program_.write(
        "room.yaml",
        "source: { simulated: { duration: 0.2 } }\ncamera: { width: 160, height: 120, fx: 130, fy: 130, cx: 80, "
        "cy: 60 }\nfeatures: { orb: { count: 300 } }\noptimizer: ceres\nrun: { mode: sequential }\n");
    program_.write(
        "segmented.yaml",
        "source: { simulated: { duration: 0.2 } }\ncamera: { width: 160, height: 120, fx: 130, fy: 130, cx: 80, "
        "cy: 60 }\nfeatures: orb\noptimizer: ceres\nsegmenter: truth\nfilters: [semantic_mask]\n");
    program_.write("matrix.yaml",
                   "base: room.yaml\nsequences:\n  room: { source: { simulated: { duration: 0.2 } } }\n");
  }

  /// Runs the command with the n-th operation below `out` failing; 0 fails nothing. Returns how many there were.
  long run(const std::vector<std::string>& arguments, long fail_at) {
    const std::string count = program_.path("count").string(), folder = program_.path("out").string();
    fs::remove(count);
    setenv("LD_PRELOAD", HOLDFAST_FAILING_FILES, 1);
    setenv("HOLDFAST_FAIL_FOLDER", folder.c_str(), 1);
    setenv("HOLDFAST_FAIL_AT", std::to_string(fail_at).c_str(), 1);
    setenv("HOLDFAST_FAIL_PARENT", std::to_string(getpid()).c_str(), 1);
    setenv("HOLDFAST_FAIL_COUNT", count.c_str(), 1);
    const pid_t process = program_.start(arguments);
    for (const char* name :
         {"LD_PRELOAD", "HOLDFAST_FAIL_FOLDER", "HOLDFAST_FAIL_AT", "HOLDFAST_FAIL_PARENT", "HOLDFAST_FAIL_COUNT"})
      unsetenv(name);
    outcome_ = program_.finish(process);
    const std::string text = program_.text("count");
    return text.empty() ? -1 : std::stol(text);
  }

  /// Runs the command with the n-th read failing of every file whose path below the folder begins so.
  void run_with_broken_file(const std::vector<std::string>& arguments, const std::string& file, int fail_at) {
    setenv("LD_PRELOAD", HOLDFAST_FAILING_FILES, 1);
    setenv("HOLDFAST_FAIL_FOLDER", program_.path(file).c_str(), 1);
    setenv("HOLDFAST_FAIL_READ_AT", std::to_string(fail_at).c_str(), 1);
    setenv("HOLDFAST_FAIL_PARENT", std::to_string(getpid()).c_str(), 1);
    const pid_t process = program_.start(arguments);
    for (const char* name : {"LD_PRELOAD", "HOLDFAST_FAIL_FOLDER", "HOLDFAST_FAIL_READ_AT", "HOLDFAST_FAIL_PARENT"})
      unsetenv(name);
    outcome_ = program_.finish(process);
  }

  /// How many faults a command meets: `usual`, or what the environment asks for.
  static long wanted_faults(long usual) {
    const char* wanted = std::getenv("HOLDFAST_WRITE_FAULTS");
    if (wanted == nullptr) return usual;
    return std::string(wanted) == "all" ? std::numeric_limits<int>::max() : std::max(1L, std::atol(wanted));
  }

  /// Lets the command meet each of at most `usual` faults, evenly over all its operations, in a new folder. Files that
  /// `may_differ` report what was done, and are whole with less in them.
  void expect_whole_or_absent(
      const std::vector<std::string>& arguments, long usual,
      const std::function<bool(const std::string&)>& may_differ = [](const std::string&) { return false; }) {
    empty_folder();
    const long operations = run(arguments, 0);
    ASSERT_EQ(outcome_.exit_code, 0) << outcome_.errors;
    ASSERT_GT(operations, 0) << "the layer counts nothing";
    const Files whole = files_below(program_.path("out"));
    empty_folder();
    run(arguments, 0);
    const Files again = files_below(program_.path("out"));
    const long most = wanted_faults(usual), step = std::max(1L, (operations + most - 1) / most);
    long faults = 0;
    for (long n = 1; n <= operations; n += step, ++faults) {
      SCOPED_TRACE("operation " + std::to_string(n) + " of " + std::to_string(operations));
      empty_folder();
      run(arguments, n);
      EXPECT_LT(outcome_.exit_code, 1000) << "killed by a signal";
      const Files left = files_below(program_.path("out"));
      if (outcome_.exit_code == 0) {  // it did without, as without a line of the poses that a killed run would leave
        for (const auto& [name, content] : whole) EXPECT_EQ(left.count(name), 1U) << name << " is absent";
      } else {
        EXPECT_NE(outcome_.errors, "");
      }
      for (const auto& [name, content] : left) {
        if (name.find(".incomplete-") != std::string::npos) continue;          // a folder that says so by its name
        if (ends_with(name, ".lock") || ends_with(name, "log.txt")) continue;  // no result, and may be empty
        const auto expected = whole.find(name);
        if (expected == whole.end())
          ADD_FAILURE() << name << " is not there without the fault";
        else if (!may_differ(name) && again.count(name) > 0 && expected->second == again.at(name))
          EXPECT_TRUE(content == expected->second || is_journal(name, content)) << name << " is not whole";
        else
          EXPECT_TRUE(is_whole(name, content)) << name << " is not whole";
      }
    }
    std::cout << arguments.front() << ": " << faults << " of " << operations << " operations failed in turn"
              << std::endl;
  }

  void empty_folder() const {
    fs::remove_all(program_.path("out"));
    fs::create_directory(program_.path("out"));
  }

  test::Program program_;
  test::Outcome outcome_;
};

TEST_F(WriteFaultsTest, Run) { expect_whole_or_absent({"run", "room.yaml", "--output", "out"}, 12); }

TEST_F(WriteFaultsTest, Simulate) {
  expect_whole_or_absent({"simulate", "--output", "out", "--duration", "0.1", "--camera", "tum_fr1"}, 10);
}

TEST_F(WriteFaultsTest, Segment) {
  expect_whole_or_absent({"segment", "segmented.yaml", "--output", "out"}, 8,
                         [](const std::string& name) { return name == "labels.txt"; });
}

TEST_F(WriteFaultsTest, Bench) {
  expect_whole_or_absent({"bench", "matrix.yaml", "--output", "out"}, 8, [](const std::string&) { return true; });
}

TEST_F(WriteFaultsTest, MapExport) {
  ASSERT_EQ(program_.run({"run", "room.yaml", "--output", "made"}).exit_code, 0);
  for (const char* format : {"--points", "--json", "--trajectory"})
    expect_whole_or_absent({"map", "export", "made/map.hfm", format, "out/exported"}, 8);
}

TEST_F(WriteFaultsTest, WhatWasWholeStaysWhenItCannotBeReplaced) {
  ASSERT_EQ(program_.run({"run", "room.yaml", "--output", "made"}).exit_code, 0);
  fs::create_directory(program_.path("out"));
  const std::vector<std::string> command = {"map", "export", "made/map.hfm", "--points", "out/a.ply", "--overwrite"};
  run(command, 0);
  const std::string before = program_.text("out/a.ply");
  ASSERT_EQ(outcome_.exit_code, 0) << outcome_.errors;
  for (const long n : {1, 2, 3, 4}) {  // to write, to sync, to close, to rename
    run(command, n);
    EXPECT_EQ(outcome_.exit_code, 1);
    EXPECT_THAT(outcome_.errors, ::testing::HasSubstr("No space left on device"));
    EXPECT_TRUE(program_.text("out/a.ply") == before);
    EXPECT_EQ(files_below(program_.path("out")).size(), 1U);
  }
}

TEST_F(WriteFaultsTest, ALimitOfTheSizeOfFilesIsAnErrorAndLeavesNoTemporaryFile) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit lower{20'000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &lower), 0);
  const pid_t process = program_.start({"run", "room.yaml", "--output", "out"});
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  outcome_ = program_.finish(process);
  EXPECT_EQ(outcome_.exit_code, 1);
  EXPECT_THAT(outcome_.errors, ::testing::HasSubstr("map.hfm: cannot be written: File too large; raise the limit"));
  const Files left = files_below(program_.path("out"));
  EXPECT_EQ(left.count("run.json"), 1U) << "the others are whole";
  for (const auto& [name, content] : left) EXPECT_FALSE(ends_with(name, ".tmp")) << name;
}

TEST_F(WriteFaultsTest, ABagThatCannotBeWrittenIsOneErrorAndHasTheFilesBesideIt) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit lower{20'000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &lower), 0);
  const pid_t process =
      program_.start({"record", "room.yaml", "--set", "source.simulated.duration=2", "--bag", "out/a.mcap"});
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  outcome_ = program_.finish(process);
  EXPECT_EQ(outcome_.exit_code, 1);
  EXPECT_THAT(outcome_.errors, ::testing::ContainsRegex("a.mcap: cannot be written: File too large\n[0-9]+ frames? "
                                                        "recorded in out/a.mcap\n$"));
  EXPECT_THAT(outcome_.errors, ::testing::Not(::testing::HasSubstr("60 frames")));
  EXPECT_FALSE(program_.text("out/a.yaml").empty());
  EXPECT_FALSE(program_.text("out/a.truth.txt").empty());
}

TEST_F(WriteFaultsTest, AReadThatFailsIsNotTheEndOfAList) {
  ASSERT_EQ(program_.run({"simulate", "--output", "rec", "--duration", "0.2", "--camera", "tum_fr1"}).exit_code, 0);
  program_.write("rec.yaml",
                 "source: { tum: { path: rec } }\ncamera: tum_fr1\nfeatures: orb\noptimizer: ceres\n"
                 "run: { mode: sequential }\n");
  // What stands before the failure is a list of frames, or a trajectory, by itself.
  for (const char* name : {"rec/rgb.txt", "rec/groundtruth.txt"}) {
    const std::string text = program_.text(name);
    program_.write(name, text + "#" + std::string(200'000, ' ') + "\n");
  }
  const std::string labels = program_.text("rec/labels.txt");
  const std::string name = labels.substr(labels.rfind('/') + 1);
  program_.write("names.txt", name.substr(0, name.rfind('.')) + "\n#" + std::string(200'000, ' ') + "\n");
  const std::vector<std::pair<const char*, std::vector<std::string>>> commands = {
      {"rec/rgb.txt", {"check", "rec.yaml"}},
      {"rec/rgb.txt", {"run", "rec.yaml", "--output", "out"}},
      {"rec/rgb.txt", {"evaluate", "rec/groundtruth.txt", "rec/groundtruth.txt", "--frames", "rec"}},
      {"rec/groundtruth.txt", {"check", "rec.yaml"}},
      {"rec/groundtruth.txt", {"evaluate", "rec/groundtruth.txt", "rec/groundtruth.txt"}},
      {"names.txt",
       {"evaluate-segmentation", "--labels", "rec/labels", "--label-map", "{0-254: person}", "--predictions",
        "rec/labels", "--prediction-map", "{0-254: person}", "--list", "names.txt"}},
      {"rec.yaml", {"check", "rec.yaml"}},
  };
  for (const auto& [file, command] : commands) {
    SCOPED_TRACE(command.front() + ", " + file);
    run_with_broken_file(command, file, std::string(file) == "rec.yaml" ? 1 : 2);
    EXPECT_EQ(outcome_.exit_code, 1) << outcome_.output;
    EXPECT_THAT(outcome_.errors,
                ::testing::AllOf(::testing::HasSubstr(file), ::testing::HasSubstr("Input/output error")));
    fs::remove_all(program_.path("out"));
  }
}

}  // namespace
}  // namespace holdfast
