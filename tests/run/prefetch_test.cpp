// SPDX-License-Identifier: BSD-3-Clause
// A sequential run whose frames another thread reads ahead gives the results of a run that reads them itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <thread>

#include "holdfast/pipeline/pipeline_builder.hpp"
#include "holdfast/run/run.hpp"
#include "holdfast/settings/ceres.hpp"
#include "holdfast/settings/orb.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"

namespace holdfast {
namespace {

constexpr std::uint64_t frame_count = 24;

simulation::Simulator& simulator() {
  static simulation::Simulator simulator(
      simulation::read_scene({}, {"camera.path=xyz"}),
      Camera{.width = 160, .height = 120, .fx = 135, .fy = 135, .cx = 79.5, .cy = 59.5});
  return simulator;
}

const std::vector<SensorFrame>& office() {
  static const std::vector<SensorFrame> frames = [] {
    std::vector<SensorFrame> all;
    for (std::uint64_t i = 0; i < frame_count; ++i) all.push_back(simulator().frame(i));
    return all;
  }();
  return frames;
}

/// What the test knows about the reading of a source.
struct Reading {
  std::atomic<std::uint64_t> frames = 0;
  std::mutex mutex;
  std::set<std::thread::id> threads;
};

/// What is wrong with a source's frames.
struct Faults {
  bool can_read_ahead = true;
  std::uint64_t broken = frame_count;      ///< the frame at which next() throws
  std::set<std::uint64_t> skipped_frames;  ///< frames that the source skips
};

/// A recording in memory.
class Recording final : public FrameSource {
 public:
  Recording(Reading& reading, Faults faults) : reading_(reading), faults_(std::move(faults)) {}
  SourceDescription describe() const override {
    return {.name = "office",
            .has_depth = true,
            .can_read_ahead = faults_.can_read_ahead,
            .frame_count = frame_count,
            .camera = simulator().camera()};
  }
  std::optional<SensorFrame> next() override {
    {
      const std::lock_guard lock(reading_.mutex);
      reading_.threads.insert(std::this_thread::get_id());
    }
    for (; faults_.skipped_frames.count(next_) > 0; ++next_) skipped_.push_back({next_, 0.0, "frame.png: is damaged"});
    if (next_ == faults_.broken) throw InputError({"frame.png"}, "is truncated");
    if (next_ == frame_count) return std::nullopt;
    ++reading_.frames;
    return office()[next_++];
  }
  std::vector<SkippedFrame> skipped() const override { return skipped_; }

 private:
  Reading& reading_;
  Faults faults_;
  std::uint64_t next_ = 0;
  std::vector<SkippedFrame> skipped_;
};

struct Outcome {
  RunRecord record;
  std::vector<Eigen::Vector3d> points;
};

Outcome run_office(int prefetch, Reading& reading, const Faults& faults = {}, const RunOptions& options = {}) {
  auto source = std::make_unique<Recording>(reading, faults);
  PipelineBuilder builder;
  builder.source(source->describe()).features(OrbSettings{.count = 300}).optimizer(CeresSettings{});
  BuiltPipeline built{std::move(source), builder.build()};
  Configuration configuration;
  configuration.file = "office.yaml";
  configuration.loop_detector.name = "none";
  configuration.run.prefetch = prefetch;
  Outcome outcome{run(built, configuration, options), {}};
  for (const auto& [id, point] : built.pipeline.map().points()) outcome.points.push_back(point.position);
  return outcome;
}

Outcome run_office(int prefetch, const Faults& faults = {}, const RunOptions& options = {}) {
  Reading reading;
  return run_office(prefetch, reading, faults, options);
}

void expect_equal(const Outcome& a, const Outcome& b) {
  EXPECT_EQ(a.record.failure, b.record.failure);
  EXPECT_EQ(a.record.was_interrupted, b.record.was_interrupted);
  EXPECT_EQ(a.record.frame_stamps, b.record.frame_stamps);
  ASSERT_EQ(a.record.trajectory.size(), b.record.trajectory.size());
  for (std::size_t i = 0; i < a.record.trajectory.size(); ++i)
    EXPECT_TRUE(a.record.trajectory[i].T_world_camera.matrix() == b.record.trajectory[i].T_world_camera.matrix()) << i;
  EXPECT_TRUE(a.points == b.points);
  ASSERT_EQ(a.record.skipped.size(), b.record.skipped.size());
  for (std::size_t i = 0; i < a.record.skipped.size(); ++i)
    EXPECT_EQ(a.record.skipped[i].index, b.record.skipped[i].index);
}

TEST(Prefetch, ResultsDoNotDependOnIt) {
  const Outcome plain = run_office(0);
  EXPECT_EQ(plain.record.trajectory.size(), frame_count);
  EXPECT_GT(plain.points.size(), 50U);
  for (const int prefetch : {1, 2, 100}) expect_equal(run_office(prefetch), plain);
}

TEST(Prefetch, AnotherThreadReadsOnlyWhereItMay) {
  const auto threads = [](int prefetch, bool can_read_ahead) {
    Reading reading;
    const Outcome outcome = run_office(prefetch, reading, {.can_read_ahead = can_read_ahead});
    EXPECT_EQ(outcome.record.summary.frames(), frame_count);
    EXPECT_FALSE(outcome.record.threads.has_value());
    return reading.threads;
  };
  const std::set<std::thread::id> self{std::this_thread::get_id()};
  EXPECT_EQ(threads(0, true), self);
  EXPECT_EQ(threads(2, false), self);
  const std::set<std::thread::id> reader = threads(2, true);
  EXPECT_EQ(reader.size(), 1U);
  EXPECT_EQ(reader.count(std::this_thread::get_id()), 0U);
}

TEST(Prefetch, FramesThatWaitAreBounded) {
  Reading reading;
  RunOptions options;
  std::uint64_t most_ahead = 0;
  options.on_frame = [&](const RunProgress& progress) {
    most_ahead = std::max(most_ahead, reading.frames - progress.frames_done);
  };
  run_office(2, reading, {}, options);
  EXPECT_LE(most_ahead, 3U);  // two that wait, and one that was just decoded
  EXPECT_GT(most_ahead, 0U);
}

TEST(Prefetch, AnErrorComesAtItsFrame) {
  const Faults faults{.broken = 9, .skipped_frames = {3}};
  const Outcome plain = run_office(0, faults);
  EXPECT_EQ(plain.record.failure, "frame.png: is truncated");
  EXPECT_EQ(plain.record.summary.frames(), 8U);
  expect_equal(run_office(2, faults), plain);
  expect_equal(run_office(2, {.broken = 0}), run_office(0, {.broken = 0}));
}

TEST(Prefetch, AStoppedRunHasSkippedWhatComesBeforeItsEnd) {
  const Faults faults{.skipped_frames = {2, 8, 11, frame_count - 1}};
  for (const std::uint64_t last : {0U, 8U, 9U}) {
    std::uint64_t done = 0;
    RunOptions options;
    options.on_frame = [&](const RunProgress& progress) {
      done = progress.frames_done;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));  // so that the reader is ahead
    };
    options.stop = [&] { return done == last; };
    const Outcome plain = run_office(0, faults, options);
    EXPECT_TRUE(plain.record.was_interrupted);
    EXPECT_EQ(plain.record.summary.frames(), last);
    EXPECT_EQ(plain.record.skipped.size(), last == 0U ? 0U : last == 8U ? 1U : 2U);
    done = 0;
    expect_equal(run_office(2, faults, options), plain);
  }
  EXPECT_EQ(run_office(2, faults).record.skipped.size(), 4U);
}

}  // namespace
}  // namespace holdfast
