// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/run/run.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <stop_token>
#include <thread>
#include <utility>

#include "holdfast/run/results.hpp"
#include "run/point_run.hpp"

namespace holdfast {
namespace {

TEST(Run, RecordsEveryFrame) {
  test::PointRun points;
  RunOptions options;
  std::vector<std::uint64_t> done;
  bool started = false;
  options.on_start = [&](const RunRecord& record) {
    started = true;
    EXPECT_TRUE(done.empty());
    EXPECT_EQ(record.source.name, "points");
  };
  options.on_frame = [&](const RunProgress& progress) {
    done.push_back(progress.frames_done);
    EXPECT_EQ(progress.frame_count, 30U);
    EXPECT_TRUE(progress.result.T_world_camera.has_value());
  };
  const RunRecord record = run(*points.built, points.configuration, options);
  EXPECT_TRUE(started);
  ASSERT_EQ(done.size(), 30U);
  EXPECT_EQ(done.front(), 1U);
  EXPECT_EQ(done.back(), 30U);
  EXPECT_EQ(record.failure, "");
  EXPECT_FALSE(record.was_interrupted);
  EXPECT_EQ(record.summary.frames(), 30U);
  EXPECT_EQ(record.frame_stamps.size(), 30U);
  EXPECT_EQ(record.trajectory.size(), 30U);
  EXPECT_EQ(record.coverage(), 1.0);
  EXPECT_EQ(record.map_keyframes, points.built->pipeline.map().keyframes().size());
  EXPECT_EQ(record.map_points, points.built->pipeline.map().points().size());
  EXPECT_GT(record.map_points, 100U);
  EXPECT_FALSE(record.threads.has_value());
  ASSERT_TRUE(record.evaluation.has_value()) << record.no_evaluation;
  EXPECT_LT(record.evaluation->absolute_error.rmse, 0.01);
  EXPECT_GT(record.start_seconds, 0.0);
  EXPECT_GE(record.total_seconds, record.start_seconds);
  EXPECT_GT(record.peak_memory, std::size_t{1} << 20U);
}

TEST(Run, StopEndsItAndUnreadFramesCountAsMissing) {
  test::PointRun points;
  RunOptions options;
  std::uint64_t frames = 0;
  options.on_frame = [&](const RunProgress& progress) { frames = progress.frames_done; };
  options.stop = [&] { return frames == 12; };
  const RunRecord record = run(*points.built, points.configuration, options);
  EXPECT_TRUE(record.was_interrupted);
  EXPECT_EQ(record.failure, "");
  EXPECT_EQ(record.summary.frames(), 12U);
  EXPECT_EQ(record.frames_expected, 30U);
  EXPECT_DOUBLE_EQ(record.coverage(), 12.0 / 30.0);
  ASSERT_TRUE(record.evaluation && record.evaluation->coverage);
  EXPECT_EQ(record.evaluation->coverage->frames, 30U);
  ASSERT_FALSE(record.evaluation->coverage->gaps.empty());
  EXPECT_EQ(record.evaluation->coverage->gaps.back().frames, 18U);
}

/// Gives one frame, and another one an hour later.
class RareSource final : public FrameSource {
 public:
  explicit RareSource(std::unique_ptr<FrameSource> source) : source_(std::move(source)) {}
  SourceDescription describe() const override { return source_->describe(); }
  std::optional<SensorFrame> next() override {
    if (!frame_) return frame_ = source_->next();
    frame_->timestamp += 3600.0;
    ++frame_->index;
    return frame_;
  }

 private:
  std::unique_ptr<FrameSource> source_;
  std::optional<SensorFrame> frame_;
};

TEST(Run, StopIsAskedWhileAPacedRunWaitsForAFrame) {
  test::PointRun points;
  points.configuration.run.mode = RunMode::threaded;
  points.configuration.run.pace = Pace::timestamps;
  points.built->source = std::make_unique<RareSource>(std::move(points.built->source));
  RunOptions options;
  int asked = 0;
  options.stop = [&] { return ++asked > 4; };
  const RunRecord record = run(*points.built, points.configuration, options);
  EXPECT_TRUE(record.was_interrupted);
  EXPECT_EQ(record.failure, "");
  EXPECT_EQ(record.summary.frames(), 1U);
}

/// Waits in its first frame until the run is interrupted.
class Waiting final : public Observer {
 public:
  explicit Waiting(std::promise<void>& waits) : waits_(waits) {}
  void on_frame(const SensorFrame&, const Frame&, const FrameResult&) override {
    if (!std::exchange(has_waited_, true)) waits_.set_value();
    interrupted_.get_future().wait();
  }
  void interrupt() noexcept override {
    if (!was_interrupted_.exchange(true)) interrupted_.set_value();
  }

 private:
  std::promise<void>& waits_;
  std::promise<void> interrupted_;
  std::atomic<bool> was_interrupted_ = false;
  bool has_waited_ = false;
};

TEST(Run, AStopTokenEndsARunWhoseObserverWaits) {
  for (const RunMode mode : {RunMode::sequential, RunMode::threaded}) {
    test::PointRun points;
    points.configuration.run.mode = mode;
    auto source = std::make_unique<test::PointSource>(points.world);
    std::promise<void> waits;
    points.built = std::make_unique<BuiltPipeline>(
        BuiltPipeline{std::move(source), points.builder().observer(std::make_unique<Waiting>(waits)).build()});
    std::stop_source stop;
    RunOptions options;
    options.stop_token = stop.get_token();
    std::jthread stopping([&] {
      waits.get_future().wait();
      stop.request_stop();
    });
    const RunRecord record = run(*points.built, points.configuration, options);
    EXPECT_TRUE(record.was_interrupted);
    EXPECT_EQ(record.failure, "");
    EXPECT_EQ(record.summary.frames(), 1U);
  }
}

TEST(Run, AFailureKeepsTheResultsBeforeIt) {
  test::PointRun points(9);
  const RunRecord record = run(*points.built, points.configuration);
  EXPECT_EQ(record.failure, "frame.png: is broken");
  EXPECT_FALSE(record.was_interrupted);
  EXPECT_EQ(record.trajectory.size(), 9U);
  test::PointRun others;
  RunOptions options;
  options.on_frame = [](const RunProgress&) { throw Error("the disk is full"); };
  EXPECT_EQ(run(*others.built, others.configuration, options).failure, "the disk is full");
}

/// A module that suspects something from the start.
class Doubtful final : public Observer {
 public:
  Warnings warnings() const override { return {{{}, "two modules say this"}}; }
};

std::vector<std::string> texts_of(const Warnings& warnings) {
  std::vector<std::string> texts;
  for (const Diagnostic& warning : warnings) texts.push_back(warning.to_string());
  return texts;
}

TEST(Run, WarningsOfConfigurationSourceAndModulesAreInEveryResult) {
  test::PointRun points;
  auto source = std::make_unique<test::PointSource>(points.world);
  PipelineBuilder builder = points.builder();
  builder.observer(std::make_unique<Doubtful>()).observer(std::make_unique<Doubtful>());
  points.built = std::make_unique<BuiltPipeline>(BuiltPipeline{std::move(source), builder.build()});
  points.configuration.warnings = {{{"points.yaml", 2, 1}, "is of another folder"}};
  const std::vector<std::string> before = {"points.yaml:2:1: is of another folder", "points.txt:3: holds few points",
                                           "two modules say this"};
  RunOptions options;
  options.on_start = [&](const RunRecord& record) { EXPECT_EQ(texts_of(record.warnings), before); };
  const RunRecord record = run(*points.built, points.configuration, options);
  std::vector<std::string> after = before;
  after.emplace_back("all frames look alike");
  EXPECT_EQ(texts_of(record.warnings), after);
  for (const std::string& text : after) EXPECT_NE(run_json(record).find('"' + text + '"'), std::string::npos) << text;
  const std::string report = report_html(record);
  for (const char* part : {"points.txt:3", "holds few points", "all frames look alike"})
    EXPECT_NE(report.find(part), std::string::npos) << part;
}

/// Repeats the colour image of frame `first` until before frame `end`; other images differ in a pixel.
class FrozenSource final : public FrameSource {
 public:
  FrozenSource(std::unique_ptr<FrameSource> source, std::uint64_t first, std::uint64_t end, bool is_simulated)
      : source_(std::move(source)), first_(first), end_(end), is_simulated_(is_simulated) {}
  SourceDescription describe() const override {
    SourceDescription description = source_->describe();
    if (is_simulated_) description.class_names = {"background", "person"};
    return description;
  }
  std::optional<SensorFrame> next() override {
    std::optional<SensorFrame> frame = source_->next();
    if (!frame) return frame;
    const bool is_frozen = frame->index >= first_ && frame->index < end_;
    frame->colour.at<cv::Vec3b>(100, 100)[1] = static_cast<std::uint8_t>(1 + (is_frozen ? first_ : frame->index));
    return frame;
  }
  Trajectory truth() const override { return source_->truth(); }

 private:
  std::unique_ptr<FrameSource> source_;
  std::uint64_t first_, end_;
  bool is_simulated_;
};

RunRecord run_of_frozen_frames(std::uint64_t first, std::uint64_t end, bool is_simulated = false) {
  test::PointRun points;
  points.built->source = std::make_unique<FrozenSource>(std::move(points.built->source), first, end, is_simulated);
  return run(*points.built, points.configuration);
}

TEST(Run, RepeatedImagesAreCountedAndNamed) {
  const RunRecord record = run_of_frozen_frames(10, 20);
  EXPECT_EQ(record.repeated_images.frames, 9U);
  EXPECT_NEAR(record.repeated_images.longest, 0.3, 1e-9);
  EXPECT_NEAR(record.repeated_images.begin, 10.0 / 30.0, 1e-9);
  ASSERT_EQ(record.warnings.size(), 1U);
  EXPECT_EQ(record.warnings[0].to_string().find("9 frames have the same colour image as the frame before"), 0U);
  EXPECT_NE(summary_text(record).find("\nrepeated images      9 frames, for up to 0.30 s\n"), std::string::npos);
}

TEST(Run, AFewRepeatedImagesAreCountedWithoutAWarning) {
  EXPECT_EQ(run_of_frozen_frames(10, 12).repeated_images.frames, 1U);
  EXPECT_TRUE(run_of_frozen_frames(10, 12).warnings.empty());
  EXPECT_EQ(run_of_frozen_frames(10, 11).repeated_images.frames, 0U);
  test::PointRun black;
  EXPECT_EQ(run(*black.built, black.configuration).repeated_images.frames, 0U) << "a covered lens repeats nothing";
}

TEST(Run, ASimulatedCameraThatStandsStillIsNotSuspectedOfRepeatingImages) {
  const RunRecord record = run_of_frozen_frames(10, 20, true);
  EXPECT_EQ(record.repeated_images.frames, 9U);
  EXPECT_TRUE(record.warnings.empty()) << record.warnings[0].to_string();
}

TEST(Run, TheLateShareCountsDelaysAboveAFrameInterval) {
  ThreadRecord threads;
  EXPECT_EQ(threads.late_share(), 0.0);
  threads.delays = {0.01, 0.033, 0.034, 1.0};
  EXPECT_EQ(threads.late_share(), 0.5);
}

}  // namespace
}  // namespace holdfast
