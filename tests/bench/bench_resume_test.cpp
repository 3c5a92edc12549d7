// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <map>

#include "cli/program.hpp"

namespace holdfast {
namespace {

namespace fs = std::filesystem;
using test::Outcome;

class BenchResumeTest : public ::testing::Test {
 protected:
  BenchResumeTest() {
    program_.write("matrix.yaml",
                   "axes:\n"
                   "  method:\n"
                   "    plain: { configuration: " HOLDFAST_SOURCE_DIR
                   "/examples/configs/rgbd.yaml }\n"
                   "    geometric: { configuration: " HOLDFAST_SOURCE_DIR
                   "/examples/configs/geometric.yaml }\n"
                   "sequences:\n"
                   "  walking: { source: { simulated: { scene: " HOLDFAST_SOURCE_DIR
                   "/examples/scenes/walking_static.yaml, duration: 1.5 } } }\n"
                   "camera: &small { width: 320, height: 240, fx: 260, fy: 260, cx: 159.5, cy: 119.5 }\n"
                   "seeds: [1, 2]\nmode: sequential\nbaseline: plain\n");
    // The camera belongs to the sequence; it stands apart above to be readable.
    std::string text = program_.text("matrix.yaml");
    const std::size_t camera = text.find("camera: &small ");
    const std::size_t end = text.find('\n', camera);
    const std::string value = text.substr(camera + 15, end - camera - 15);
    text.erase(camera, end - camera + 1);
    text.insert(text.find("duration: 1.5 } }") + 17, ", camera: " + value);
    program_.write("matrix.yaml", text);
  }

  std::size_t finished(const std::string& output) const {
    std::size_t count = 0;
    std::error_code ignored;
    for (fs::recursive_directory_iterator entry(program_.path(output) / "runs", ignored), last;
         !ignored && entry != last; entry.increment(ignored))
      count += entry.depth() == 3 && entry->path().filename() == "result.json" &&
                       entry->path().parent_path().filename().string().front() != '.'
                   ? 1
                   : 0;
    return count;
  }

  /// Everything that must not depend on how often the bench was killed.
  std::map<std::string, std::string> accuracy(const std::string& output) const {
    std::map<std::string, std::string> files;
    for (const char* name : {"report.md", "tables/runs.csv", "tables/cells.csv", "tables/improvements.csv",
                             "tables/comparisons.csv", "tables/published.csv"})
      files[name] = program_.text(output + "/" + name);
    for (const char* method : {"plain", "geometric"})
      for (const char* seed : {"1", "2"})
        for (const char* name : {"result.json", "trajectory.txt", "config.yaml", "tracks.json"}) {
          const std::string file = std::string("runs/") + method + "/walking/seed" + seed + "-repeat1/" + name;
          files[file] = program_.text(output + "/" + file);
        }
    return files;
  }

  /// Lets it work until so many runs are finished and the next one has begun, then kills it.
  void kill_after(const std::vector<std::string>& arguments, std::size_t runs) const {
    const pid_t process = program_.start(arguments);
    while (finished("killed") < runs) usleep(5'000);
    usleep(300'000);
    kill(process, SIGKILL);
    const Outcome outcome = program_.finish(process);
    ASSERT_EQ(outcome.exit_code, 1000 + SIGKILL) << "it ended before it was killed\n" << outcome.errors;
  }

  test::Program program_;
};

TEST_F(BenchResumeTest, KilledTwiceGivesTheSameTablesByteForByte) {
  const Outcome whole = program_.run({"bench", "matrix.yaml", "--output", "whole"});
  ASSERT_EQ(whole.exit_code, 0) << whole.errors;
  ASSERT_EQ(finished("whole"), 4U);

  kill_after({"bench", "matrix.yaml", "--output", "killed"}, 1);
  EXPECT_LT(finished("killed"), 4U);
  kill_after({"bench", "matrix.yaml", "--output", "killed", "--resume"}, 2);
  EXPECT_LT(finished("killed"), 4U);
  const Outcome resumed = program_.run({"bench", "matrix.yaml", "--output", "killed", "--resume"});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.errors;
  EXPECT_THAT(resumed.output, ::testing::HasSubstr("runs were finished before"));

  const auto expected = accuracy("whole");
  const auto found = accuracy("killed");
  for (const auto& [name, text] : expected) {
    EXPECT_GT(text.size(), 20U) << name;
    EXPECT_EQ(found.at(name), text) << name;
  }
  // Nothing half-done is left.
  for (const auto& entry : fs::recursive_directory_iterator(program_.path("killed/runs")))
    EXPECT_NE(entry.path().filename().string().front(), '.') << entry.path();
}

}  // namespace
}  // namespace holdfast
