// SPDX-License-Identifier: BSD-3-Clause
// Runs that are stopped at any moment leave a folder that can be read. HOLDFAST_STOPS sets how often.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "cli/program.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

namespace fs = std::filesystem;

class StopTest : public ::testing::Test {
 protected:
  StopTest() {
    program_.write("room.yaml",
                   "source: { simulated: { scene: " HOLDFAST_SOURCE_FOLDER
                   "/examples/scenes/walking_xyz.yaml, duration: 2 } }\n"
                   "camera: { width: 160, height: 120, fx: 135, fy: 135, cx: 79.5, cy: 59.5 }\n"
                   "features: { orb: { count: 300 } }\noptimizer: ceres\nloop_detector: flann\nsegmenter: truth\n"
                   "filters: [semantic_mask, multi_view_depth]\n"
                   "run: { mode: threaded, pace: timestamps, late_frames: drop }\n");
  }

  void expect_readable() const {
    if (!fs::exists(program_.path("out"))) return;
    for (const auto& entry : fs::directory_iterator(program_.path("out"))) {
      const std::string name = entry.path().filename().string(), text = test::content(entry.path());
      EXPECT_NE(entry.path().extension(), ".tmp") << name;
      if (entry.path().extension() == ".json") {
        EXPECT_TRUE(nlohmann::json::accept(text)) << name;
      }
      if (entry.path().extension() == ".txt" && !text.empty()) {
        EXPECT_EQ(text.back(), '\n') << name;
      }
      if (entry.path().extension() == ".hfm") {
        EXPECT_EQ(program_.run({"map", "info", entry.path().string()}).exit_code, 0) << name;
      }
    }
  }

  test::Program program_;
};

TEST_F(StopTest, LeavesAReadableFolder) {
  const char* wanted = std::getenv("HOLDFAST_STOPS");
  const int count = wanted == nullptr ? 6 : std::atoi(wanted);
  Random random(static_cast<std::uint64_t>(count));
  for (int i = 0; i < count; ++i) {
    // The first and every second one once there is something to lose, the others from the start on.
    const bool waits = i % 2 == 0;
    const int moment = static_cast<int>(random.below(waits ? 1000 : 2500)), signal = i % 3 == 2 ? SIGTERM : SIGINT;
    SCOPED_TRACE("signal " + std::to_string(signal) + " after " + std::to_string(moment) + " ms" +
                 (waits ? " from the first pose on" : ""));
    fs::remove_all(program_.path("out"));
    const pid_t process = program_.start({"run", "room.yaml", "--output", "out", "--quiet"});
    if (waits) program_.wait_for_poses(process, "out");
    std::this_thread::sleep_for(std::chrono::milliseconds(moment));
    kill(process, signal);
    const test::Outcome outcome = program_.finish(process);
    // Finished, without a pose yet, stopped, or ended by the signal before the program asked for it.
    EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 1 || outcome.exit_code == 128 + SIGINT ||
                outcome.exit_code == 128 + SIGTERM || outcome.exit_code == 1000 + signal)
        << outcome.exit_code << "\n"
        << outcome.errors;
    expect_readable();
    EXPECT_TRUE(fs::exists(program_.path("out/run.json")) || !waits);
  }
}

TEST_F(StopTest, IsAnsweredWhileAPacedRunWaitsForItsNextFrame) {
  ASSERT_EQ(program_.run({"simulate", "--output", "rec", "--duration", "0.3", "--camera", "tum_fr1"}).exit_code, 0);
  program_.write("paced.yaml",
                 "source: { tum: { path: rec } }\ncamera: tum_fr1\nfeatures: orb\noptimizer: ceres\n"
                 "run: { mode: threaded, pace: timestamps }\n");
  // The last frame comes an hour later.
  for (const char* list : {"rec/rgb.txt", "rec/depth.txt"}) {
    std::string text = program_.text(list);
    const std::size_t last = text.rfind('\n', text.size() - 2) + 1;
    program_.write(list, text.insert(last, "360"));
  }
  for (const int signal : {SIGINT, SIGTERM}) {
    const pid_t process = program_.start({"run", "paced.yaml", "--output", "out", "--quiet", "--overwrite"});
    program_.wait_until(process, [&] { return fs::exists(program_.path("out/trajectory.txt")); });
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));  // of which the other frames need 300
    kill(process, signal);
    const bool has_ended = program_.wait_until(process, [] { return false; });
    EXPECT_TRUE(has_ended) << "after signal " << signal;
    if (!has_ended) kill(process, SIGKILL);
    EXPECT_EQ(program_.finish(process).exit_code, 128 + signal);
    EXPECT_TRUE(fs::exists(program_.path("out/run.json")));
  }
}

}  // namespace
}  // namespace holdfast
