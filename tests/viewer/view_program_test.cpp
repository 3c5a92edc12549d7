// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>

#include "cli/program.hpp"
#include "viewer/page_fit.hpp"
#include "viewer/socket_client.hpp"

namespace holdfast {
namespace {

using test::becomes;
using test::expect_it_fits;
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

TEST_F(ViewProgramTest, ServesBrowsersWhereSilentConnectionsTakeAllDescriptors) {
  ASSERT_EQ(program_.run({"run", "run.yaml", "--output", "out", "--set", "source.simulated.duration=0.2"}).exit_code,
            0);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit few{32, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  const pid_t view = start({"view", "out"});
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  {
    std::vector<test::SilentClient> silent;
    for (int i = 0; i < 64; ++i) silent.emplace_back(address());
    test::SocketClient client(address());
    client.receive_until(is_finished);
    EXPECT_TRUE(silent.front().is_closed());
    EXPECT_FALSE(silent.back().is_closed()) << "nobody had to wait for the end of their time";
  }
  kill(view, SIGTERM);
  EXPECT_EQ(program_.finish(view).exit_code, 0);
}

TEST_F(ViewProgramTest, ShowsTheDenseCloudOfARunAndOfItsResults) {
  const auto has_cloud = [](const ReceivedMessage& message) { return message.has("surface_places"); };
  const pid_t run = start({"run", "run.yaml", "--output", "out", "--view", "--set", "dense_map.enabled=true", "--set",
                           "observers=[{viewer: {wait: true}}]"});
  {
    test::SocketClient client(address());
    EXPECT_FALSE(is_finished(client.receive_until(has_cloud))) << "while the run goes";
    client.receive_until(is_finished);
  }
  kill(run, SIGINT);
  EXPECT_EQ(program_.finish(run).exit_code, 0);
  const pid_t view = start({"view", "out"});
  {
    test::SocketClient client(address());
    const ReceivedMessage message = client.receive_until(has_cloud);
    EXPECT_GT(message.array<float>("surface_places").size(), 3U * 1000U);
    EXPECT_EQ(message.array<float>("surface_places").size(), message.array<std::uint8_t>("surface_colours").size());
  }
  kill(view, SIGTERM);
  EXPECT_EQ(program_.finish(view).exit_code, 0);
  std::filesystem::resize_file(program_.path("out/static_map.ply"), 1000);
  const test::Outcome outcome = program_.run({"view", "out"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("static_map.ply: states"));
}

TEST_F(ViewProgramTest, ShowsTheClassesOfARunAndOfItsResults) {
  constexpr std::uint8_t no_class = 255;
  const auto has_classes = [](const ReceivedMessage& message) {
    if (!message.has("point_classes")) return false;
    const auto labels = message.array<std::uint8_t>("point_classes");
    return std::any_of(labels.begin(), labels.end(), [](std::uint8_t label) { return label != no_class; });
  };
  const pid_t run = start({"run", "run.yaml", "--output", "out", "--view", "--set", "segmenter=truth"});
  {
    test::SocketClient client(address());
    client.receive_until(has_classes);
    client.receive_until(is_finished);
  }
  kill(run, SIGINT);
  EXPECT_EQ(program_.finish(run).exit_code, 0);
  for (const char* shown : {"out", "out/map.hfm"}) {
    const pid_t view = start({"view", shown});
    {
      test::SocketClient client(address());
      const ReceivedMessage message = client.receive_until(has_classes);
      EXPECT_EQ(message.json["head"]["classes"][0], "background");
    }
    kill(view, SIGTERM);
    EXPECT_EQ(program_.finish(view).exit_code, 0);
  }
  EXPECT_THAT(program_.run({"map", "info", "out/map.hfm"}).output, HasSubstr("\nclasses    \"background\" "));
}

/// The address as the program prints it.
std::string text_of(const test::ViewerAddress& address) {
  return "http://" + address.host + ":" + address.port + "/?token=" + address.token;
}

TEST_F(ViewProgramTest, InAChromiumWhileItRunsAndAfterwards) {
  const auto chromium = test::find_browser();
  if (!chromium) GTEST_SKIP() << "no chromium, chromium-browser or google-chrome in PATH to look at the page with";
  test::Browser browser(*chromium, program_.path("profile"));
  const std::string counts = "globalThis.holdfastViewer?.counts()";
  const pid_t run = start({"run", "run.yaml", "--output", "out", "--view", "--set", "dense_map.enabled=true", "--set",
                           "observers=[{viewer: {wait: true, speed: 1}}]"});
  browser.open_page(text_of(address()));
  EXPECT_TRUE(
      becomes(browser, counts + "?.points > 100 && " + counts + ".path > 3 && " + counts + ".picture !== null"));
  EXPECT_TRUE(becomes(browser, counts + ".cloud > 1000"));
  expect_it_fits(browser);
  EXPECT_TRUE(becomes(browser, counts + ".state.finished && " + counts + ".path === 45 && " + counts + ".truth > 40"));
  expect_it_fits(browser);
  kill(run, SIGINT);
  EXPECT_EQ(program_.finish(run).exit_code, 0);
  EXPECT_TRUE(becomes(browser, "document.getElementById('state').textContent === 'finished, offline'"));

  const pid_t view = start({"view", "out"});
  browser.open_page(text_of(address()));
  EXPECT_TRUE(becomes(browser, counts + "?.points > 100 && " + counts + ".path === 45 && " + counts + ".cloud > 1000"));
  EXPECT_TRUE(becomes(browser,
                      "!document.getElementById('error-panel').hidden && "
                      "!document.getElementById('slider').hidden"));
  EXPECT_TRUE(becomes(browser, "document.getElementById('colourings').hidden")) << "there was no segmenter";
  expect_it_fits(browser);
  kill(view, SIGTERM);
  EXPECT_EQ(program_.finish(view).exit_code, 0);

  browser.open_page("file://" + program_.path("out/report.html").string());
  expect_it_fits(browser);
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
