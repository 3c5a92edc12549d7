// SPDX-License-Identifier: BSD-3-Clause
// Paced runs whose modules are too slow, so that frames really are dropped, and runs that are stopped at any moment.
// HOLDFAST_STOPS sets how often.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "holdfast/core/random.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/pipeline/pipeline_builder.hpp"
#include "holdfast/run/run.hpp"
#include "holdfast/settings/ceres.hpp"
#include "holdfast/settings/flann.hpp"
#include "holdfast/settings/orb.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"

extern "C" void holdfast_register_plugin_ceres(holdfast::Registry&);

namespace holdfast {
namespace {

/// Occupies the processor, as a computation does.
void be_busy(double seconds) {
  const Stopwatch watch;
  while (watch.seconds() < seconds) {
  }
}

/// Ceres, after a while.
class SlowOptimizer final : public Optimizer {
 public:
  SlowOptimizer() {
    Registry registry;
    holdfast_register_plugin_ceres(registry);
    optimizer_ = registry.create<Optimizer>("ceres", {}, {});
  }
  PoseSummary optimize_pose(PoseProblem& problem) override {
    be_busy(0.03);
    return optimizer_->optimize_pose(problem);
  }
  BundleSummary optimize_bundle(BundleProblem& problem, const std::atomic<bool>& stop) override {
    be_busy(0.1);
    return optimizer_->optimize_bundle(problem, stop);
  }
  GraphSummary optimize_pose_graph(PoseGraphProblem& problem) override {
    return optimizer_->optimize_pose_graph(problem);
  }

 private:
  std::unique_ptr<Optimizer> optimizer_;
};

/// Sees nobody, after a while.
class SlowSegmenter final : public Segmenter {
 public:
  const std::vector<std::string>& classes() const override {
    static const std::vector<std::string> names{"background", "person"};
    return names;
  }
  Segmentation segment(const SensorFrame& frame) override {
    be_busy(0.15);
    Segmentation segmentation;
    segmentation.labels = cv::Mat::zeros(frame.colour.size(), CV_8UC1);
    return segmentation;
  }
};

/// A short recording of the empty office, rendered once.
const std::vector<SensorFrame>& office(Camera& camera) {
  static simulation::Simulator simulator(
      simulation::read_scene({}, {"camera.path=xyz"}),
      Camera{.width = 160, .height = 120, .fx = 135, .fy = 135, .cx = 79.5, .cy = 59.5});
  static const std::vector<SensorFrame> frames = [] {
    std::vector<SensorFrame> all;
    for (std::uint64_t i = 0; i < 45; ++i) all.push_back(simulator.frame(i));
    return all;
  }();
  camera = simulator.camera();
  return frames;
}

class OfficeSource final : public FrameSource {
 public:
  OfficeSource() : frames_(office(camera_)) {}
  SourceDescription describe() const override {
    return {.name = "office", .has_depth = true, .frame_count = frames_.size(), .camera = camera_};
  }
  std::optional<SensorFrame> next() override {
    if (next_ == frames_.size()) return std::nullopt;
    return frames_[next_++];
  }

 private:
  Camera camera_;
  const std::vector<SensorFrame>& frames_;
  std::size_t next_ = 0;
};

RunRecord busy_run(const RunSettings& settings, const RunOptions& options = {}) {
  auto source = std::make_unique<OfficeSource>();
  PipelineBuilder builder;
  builder.source(source->describe())
      .features(OrbSettings{.count = 300})
      .optimizer({std::make_unique<SlowOptimizer>(), "slow"})
      .segmenter(std::make_unique<SlowSegmenter>())
      .filter("semantic_mask")
      .loop_detector(FlannSettings{})
      .run(settings);
  BuiltPipeline built{std::move(source), builder.build()};
  Configuration configuration;
  configuration.file = "office.yaml";
  configuration.run = settings;
  return run(built, configuration, options);
}

const RunSettings paced = {.mode = RunMode::threaded,
                           .pace = Pace::timestamps,
                           .late_frames = LateFrames::drop,
                           .frame_queue = 2,
                           .keyframe_queue = 1};

TEST(BusyThreads, DroppedFramesAreCountedAndTheRestIsTracked) {
  const RunRecord record = busy_run(paced);
  EXPECT_EQ(record.failure, "");
  ASSERT_TRUE(record.threads.has_value());
  const ThreadRecord& threads = *record.threads;
  EXPECT_GT(threads.frames.dropped, 0U);
  EXPECT_EQ(threads.frames.taken + threads.frames.dropped, 45U);
  EXPECT_EQ(record.summary.frames(), threads.frames.taken);
  EXPECT_EQ(record.frame_stamps.size(), 45U);
  EXPECT_EQ(record.frames_expected, 45U);
  EXPECT_LE(record.trajectory.size(), record.summary.frames());
  EXPECT_GT(record.trajectory.size(), 0U);
  EXPECT_DOUBLE_EQ(record.coverage(), static_cast<double>(record.trajectory.size()) / 45.0);
  EXPECT_EQ(threads.delays.size(), record.summary.frames());
  for (const WorkerCounts& worker : threads.workers) EXPECT_LE(worker.queue.longest, worker.queue.capacity);
}

TEST(BusyThreads, QueuedFramesAreAllTracked) {
  RunSettings settings = paced;
  settings.late_frames = LateFrames::queue;
  const RunRecord record = busy_run(settings);
  EXPECT_EQ(record.failure, "");
  ASSERT_TRUE(record.threads.has_value());
  EXPECT_EQ(record.threads->frames.dropped, 0U);
  EXPECT_EQ(record.summary.frames(), 45U);
}

TEST(BusyThreads, AStopAtAnyMomentEndsTheRun) {
  const char* wanted = std::getenv("HOLDFAST_STOPS");
  const int count = wanted == nullptr ? 4 : std::atoi(wanted);
  Random random(static_cast<std::uint64_t>(count));
  for (int i = 0; i < count; ++i) {
    const double moment = random.uniform(0.0, 1.5);
    SCOPED_TRACE("stopped after " + std::to_string(moment) + " s");
    RunOptions options;
    const Stopwatch watch;
    options.stop = [&] { return watch.seconds() > moment; };
    const RunRecord record = busy_run(paced, options);
    EXPECT_EQ(record.failure, "");
    EXPECT_LE(record.trajectory.size(), record.summary.frames());
    EXPECT_EQ(record.was_interrupted, record.summary.frames() + record.threads->frames.dropped < 45U);
  }
}

}  // namespace
}  // namespace holdfast
