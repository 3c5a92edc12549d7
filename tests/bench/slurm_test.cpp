// SPDX-License-Identifier: BSD-3-Clause
// The executor `slurm` with real daemons: a controller and two virtual nodes on this machine, started and stopped here.
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <map>

#include "bench/listed_recording.hpp"
#include "cli/program.hpp"

namespace holdfast {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using ::testing::HasSubstr;

class SlurmTest : public ::testing::Test {
 protected:
  static constexpr int repeats = 4;
  static constexpr const char* systems[] = {"good", "half", "nan"};

  void SetUp() override {
    if (const int code = cluster("start", "1"); code == 77)
      GTEST_SKIP() << test::content(program_.path("cluster.log"))
                   << "Debian: slurmctld slurmd slurm-client munge, and the rights of root";
    else
      ASSERT_EQ(code, 0) << test::content(program_.path("cluster.log"));
    is_up_ = true;
    setenv("SLURM_CONF", program_.path("cluster/slurm.conf").c_str(), 1);
    test::write_listed_recording(program_, "recording");
    std::string matrix = "baseline: good\nexecutor: { slurm: { partition: test, poll_seconds: 0.3 } }\nsystems:\n";
    for (const std::string mood : systems)
      matrix += "  " + mood + ":\n    command: [sh, -c, 'echo $SLURMD_NODENAME $$ >> " +
                program_.path("started").string() +
                "; sleep 1; exec sh " HOLDFAST_SOURCE_DIR
                "/examples/external/stand_in.sh \"$@\"', stand_in, '{associations}', '{settings}', '{sequence}', "
                "'{output}/trajectory.txt']\n    environment: { STAND_IN: " +
                mood + " }\n    repeats: " + std::to_string(repeats) + "\n";
    matrix += "sequences: { little: { source: { tum: { path: recording, frames: 50 } }, camera: tum_fr3 } }\n";
    program_.write("matrix.yaml", matrix);
  }
  void TearDown() override {
    if (is_up_) cluster("stop");
  }

  int cluster(const std::string& command, const std::string& argument = "") const {
    const std::string line = "sh " HOLDFAST_SOURCE_DIR "/tests/support/slurm_cluster.sh " + command + " " +
                             program_.path("cluster").string() + " " + argument + " > " +
                             program_.path("cluster.log").string() + " 2>&1";
    return WEXITSTATUS(std::system(line.c_str()));
  }
  /// Kills a daemon as a power cut does, or the process whose number a file holds.
  void kill_daemon(const std::string& name) const {
    kill(std::stoi(test::content(program_.path("cluster/" + name + ".process"))), SIGKILL);
  }
  std::vector<std::string> started() const {
    std::istringstream lines(test::content(program_.path("started")));
    std::vector<std::string> found;
    for (std::string line; std::getline(lines, line);) found.push_back(line);
    return found;
  }
  /// Kills what Slurm started for a line of started(): the parent of the system under test.
  static void kill_job(const std::string& line) {
    std::istringstream status(test::content("/proc/" + line.substr(line.find(' ') + 1) + "/status"));
    std::string word;
    while (status >> word && word != "PPid:") {
    }
    pid_t parent = 0;
    ASSERT_TRUE(status >> parent) << "it ended before it was killed";
    ASSERT_GT(parent, 1);
    kill(parent, SIGKILL);
  }
  void wait_for_starts(std::size_t count) const {
    for (int i = 0; i < 1200 && started().size() < count; ++i) usleep(50'000);
    ASSERT_GE(started().size(), count);
  }
  /// Everything that must not depend on where runs were executed.
  std::map<std::string, std::string> accuracy(const std::string& output) const {
    std::map<std::string, std::string> files;
    for (const char* name : {"report.md", "tables/runs.csv", "tables/cells.csv", "tables/improvements.csv",
                             "tables/comparisons.csv", "tables/published.csv"})
      files[name] = program_.text(output + "/" + name);
    return files;
  }
  void expect_as_local(const std::string& output) const {
    const Outcome local =
        program_.run({"bench", "matrix.yaml", "--output", "local", "--executor", "local", "--jobs", "4"});
    ASSERT_EQ(local.exit_code, 0) << local.errors;
    const auto expected = accuracy("local"), found = accuracy(output);
    for (const auto& [name, text] : expected) EXPECT_EQ(found.at(name), text) << name;
    EXPECT_EQ(std::count(expected.at("tables/runs.csv").begin(), expected.at("tables/runs.csv").end(), '\n'),
              1 + repeats * static_cast<int>(std::size(systems)));
    for (const auto& entry : fs::recursive_directory_iterator(program_.path(output + "/runs")))
      EXPECT_NE(entry.path().filename().string().front(), '.') << entry.path();
  }

  test::Program program_;
  bool is_up_ = false;
};

TEST_F(SlurmTest, GivesTheBytesOfALocalBenchFromTwoNodes) {
  const Outcome outcome = program_.run({"bench", "matrix.yaml", "--output", "cluster_out", "--slurm", "array_size=5"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.errors, HasSubstr("[12/12] "));
  std::map<std::string, int> nodes;
  for (const std::string& line : started()) ++nodes[line.substr(0, line.find(' '))];
  EXPECT_EQ(nodes.size(), 2U) << "both nodes have work";
  EXPECT_EQ(nodes["holdfast0"] + nodes["holdfast1"], 12) << "every run was executed once";
  EXPECT_TRUE(fs::exists(program_.path("cluster_out/slurm/batch-2/runs.txt"))) << "arrays of five";
  expect_as_local("cluster_out");
}

TEST_F(SlurmTest, SurvivesTheEndOfANodeOfAJobOfTheControllerAndOfTheBench) {
  const pid_t bench = program_.start({"bench", "matrix.yaml", "--output", "killed"});
  wait_for_starts(2);
  kill_daemon("slurmd0");
  kill_job(started().back());
  ASSERT_EQ(cluster("restart", "slurmd0"), 0);
  wait_for_starts(4);
  kill_daemon("slurmctld");
  usleep(1'000'000);
  kill(bench, SIGKILL);
  EXPECT_EQ(program_.finish(bench).exit_code, 1000 + SIGKILL);
  ASSERT_EQ(cluster("restart", "slurmctld"), 0);

  const Outcome outcome = program_.run({"bench", "matrix.yaml", "--output", "killed", "--attach"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_GT(started().size(), 12U) << "the killed job was executed again";
  expect_as_local("killed");
}

TEST_F(SlurmTest, IsStoppedByASignal) {
  const pid_t bench = program_.start({"bench", "matrix.yaml", "--output", "stopped"});
  wait_for_starts(2);
  kill(bench, SIGINT);
  const Outcome outcome = program_.finish(bench);
  EXPECT_EQ(outcome.exit_code, 130) << outcome.errors;
  const std::size_t count = started().size();
  usleep(2'500'000);
  EXPECT_EQ(started().size(), count) << "no job is left in the queue";
  ASSERT_EQ(program_.run({"bench", "matrix.yaml", "--output", "stopped", "--resume"}).exit_code, 0);
  expect_as_local("stopped");
}

TEST_F(SlurmTest, SaysWhatIsWrong) {
  Outcome outcome = program_.run({"bench", "matrix.yaml", "--output", "a", "--slurm", "partition=nowhere"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("sbatch refused the jobs of the bench"));
  outcome = program_.run({"bench", "matrix.yaml", "--output", "b", "--slurm", "partitoin=x"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.errors, HasSubstr("slurm has no option 'partitoin'; did you mean 'partition'"));
}

}  // namespace
}  // namespace holdfast
