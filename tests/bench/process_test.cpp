// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/process.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>

namespace holdfast {
namespace {

class ProcessTest : public ::testing::Test {
 protected:
  ProcessTest() : log_(std::filesystem::temp_directory_path() / ("holdfast_process_" + std::to_string(getpid()))) {}
  ~ProcessTest() override { std::filesystem::remove(log_); }

  ProcessRequest request(const std::string& script) const {
    return {{"sh", "-c", script}, "/", {{"WHO", "bench"}}, log_};
  }
  static ProcessEnd wait_for(Process& process) {
    while (true) {
      if (const auto end = process.poll()) return *end;
      wait_for_processes(1.0);
    }
  }
  std::string log() const {
    std::ostringstream text;
    text << std::ifstream(log_).rdbuf();
    return text.str();
  }

  std::filesystem::path log_;
};

TEST_F(ProcessTest, TellsHowItEnded) {
  Process process(request("pwd; echo $WHO >&2; exit 3"));
  const ProcessEnd end = wait_for(process);
  EXPECT_TRUE(end.was_started);
  EXPECT_EQ(end.exit_code, 3);
  EXPECT_EQ(end.signal, 0);
  EXPECT_EQ(log(), "/\nbench\n");
  EXPECT_GT(end.peak_memory, 100'000U);
  EXPECT_LT(end.peak_memory, 100'000'000U);
}

TEST_F(ProcessTest, TellsOfSignals) {
  Process process(request("kill -SEGV $$"));
  EXPECT_EQ(wait_for(process).signal, SIGSEGV);
}

TEST_F(ProcessTest, TellsOfProgramsThatAreNotThere) {
  Process process({{"/no/such/program"}, "", {}, log_});
  EXPECT_FALSE(wait_for(process).was_started);
}

TEST_F(ProcessTest, EndsWithItsChildren) {
  const std::filesystem::path mark = log_.string() + "_mark";
  std::filesystem::remove(mark);
  Process process(request("(sleep 0.4; touch " + mark.string() + ") & echo begun; wait"));
  while (log().empty()) wait_for_processes(0.01);
  process.terminate();
  EXPECT_EQ(wait_for(process).signal, SIGTERM);
  usleep(600'000);
  EXPECT_FALSE(std::filesystem::exists(mark));
}

TEST_F(ProcessTest, CountsTheTimeOfItsChildren) {
  Process process(request("sh -c 'i=0; while [ $i -lt 100000 ]; do i=$((i + 1)); done'"));
  const ProcessEnd end = wait_for(process);
  EXPECT_GT(end.user_seconds + end.system_seconds, 0.005);
}

}  // namespace
}  // namespace holdfast
