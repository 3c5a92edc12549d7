// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <csignal>

#include "cli/program.hpp"
#include "viewer/socket_client.hpp"

namespace holdfast {
namespace {

using test::ReceivedMessage;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class ViewProgramTest : public testing::Test {
 protected:
  void SetUp() override {
    program_.write("run.yaml",
                   "source: { simulated: { duration: 1.5 } }\ncamera: tum_fr1\nfeatures: orb\noptimizer: schur\n");
  }
  /// Starts the program; what an earlier one printed is gone.
  pid_t start(const std::vector<std::string>& arguments) const {
    std::filesystem::remove(program_.path("stdout"));
    return program_.start(arguments);
  }
  /// The address that the program prints.
  test::ViewerAddress address() const {
    for (int i = 0; i < 2400; ++i) {
      const std::string output = program_.text("stdout");
      const std::size_t begin = output.find("http://"), end = output.find('\n', begin);
      if (begin != std::string::npos && end != std::string::npos)
        return test::ViewerAddress(output.substr(begin, end - begin));
      usleep(25'000);
    }
    throw std::runtime_error("no address: " + program_.text("stdout") + program_.text("stderr"));
  }
  static bool is_finished(const ReceivedMessage& message) {
    return message.json.contains("state") && message.json["state"]["finished"] == true;
  }

  test::Program program_;
};

TEST_F(ViewProgramTest, ShowsARunUntilItIsStoppedAndItsResultsLater) {
  const pid_t run = start({"run", "run.yaml", "--output", "out", "--view"});
  {
    test::SocketClient client(address());
    client.receive_until(is_finished);
  }
  kill(run, SIGINT);
  const test::Outcome outcome = program_.finish(run);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_TRUE(std::filesystem::exists(program_.path("out/report.html")));
  EXPECT_THAT(program_.text("out/config.yaml"), HasSubstr("viewer:"));

  for (const char* shown : {"out", "out/map.hfm"}) {
    const pid_t view = start({"view", shown});
    {
      test::SocketClient client(address());
      const ReceivedMessage message = client.receive_until(is_finished);
      EXPECT_TRUE(message.has("point_slots"));
      EXPECT_TRUE(message.has("path_values"));
      const bool is_folder = std::string(shown) == "out";
      EXPECT_EQ(message.has("truth_places"), is_folder);
      EXPECT_EQ(message.json["run"]["has_errors"], is_folder);
      if (is_folder) {
        EXPECT_EQ(message.json["run"]["figures"][0][0], "ATE RMSE");
        EXPECT_THAT(message.array<double>("path_stamps"), SizeIs(45));
        // The truth lies on the path, which it is compared with.
        const auto path = message.array<float>("path_values"), truth = message.array<float>("truth_places");
        EXPECT_NEAR(path[9 * 40], truth[3 * 40], 0.02);
        EXPECT_NEAR(path[9 * 40 + 2], truth[3 * 40 + 2], 0.02);
      }
    }
    kill(view, SIGTERM);
    EXPECT_EQ(program_.finish(view).exit_code, 0);
  }
}

TEST_F(ViewProgramTest, SameBytesWithAndWithoutABrowser) {
  ASSERT_EQ(program_.run({"run", "run.yaml", "--output", "alone"}).exit_code, 0);
  const pid_t run = program_.start(
      {"run", "run.yaml", "--output", "watched", "--view", "--set", "observers=[{viewer: {wait: true}}]"});
  {
    test::SocketClient client(address());
    client.receive();
    client.send("pause");
    client.send("step");
    client.send("speed 4");
    client.send("resume");
    client.receive_until(is_finished);
  }
  kill(run, SIGINT);
  EXPECT_EQ(program_.finish(run).exit_code, 0);
  EXPECT_EQ(program_.text("watched/trajectory.txt"), program_.text("alone/trajectory.txt"));
}

TEST_F(ViewProgramTest, ASignalEndsARunThatWaits) {
  const pid_t run =
      program_.start({"run", "run.yaml", "--output", "out", "--set", "observers=[{viewer: {wait: true}}]"});
  address();
  usleep(300'000);
  kill(run, SIGINT);
  EXPECT_EQ(program_.finish(run).exit_code, 130);
}

TEST_F(ViewProgramTest, SaysWhatCannotBeShown) {
  std::filesystem::create_directory(program_.path("empty"));
  test::Outcome outcome = program_.run({"view", "empty"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("holds neither trajectory.txt nor map.hfm"));
  program_.write("empty/trajectory.txt", "1 0 0 0 0 0 0 1\n");
  program_.write("empty/run.json", "[1, 2");
  outcome = program_.run({"view", "empty"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("run.json: is no JSON that a run has written"));
  program_.write("empty/run.json", "{}");
  program_.write("empty/tracks.json", "{\"truth\": [[1, 2]], \"estimate\": [], \"error\": []}");
  outcome = program_.run({"view", "empty"});
  EXPECT_THAT(outcome.errors, HasSubstr("tracks.json: 'truth' is no list of rows with 4 numbers"));
}

}  // namespace
}  // namespace holdfast
