// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/run/frame_feeder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <thread>

#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

using namespace std::chrono_literals;

/// Frames 0, 1, 2 ... at 100 a second; may throw at one of them.
class CountingSource final : public FrameSource {
 public:
  explicit CountingSource(std::uint64_t count, std::uint64_t bad = ~std::uint64_t{0}) : count_(count), bad_(bad) {}
  SourceDescription describe() const override { return {}; }
  std::optional<SensorFrame> next() override {
    if (index_ == bad_) throw InputError({"frame.png"}, "is broken");
    if (index_ >= count_) return std::nullopt;
    SensorFrame frame;
    frame.timestamp = 0.01 * static_cast<double>(index_);
    frame.index = index_++;
    return frame;
  }

 private:
  std::uint64_t count_, bad_, index_ = 0;
};

TEST(FrameFeeder, GivesEveryFrameInOrder) {
  CountingSource source(200);
  FrameFeeder feeder(source, {});
  std::uint64_t expected = 0;
  while (const auto fed = feeder.next()) EXPECT_EQ(fed->frame.index, expected++);
  EXPECT_EQ(expected, 200U);
  EXPECT_EQ(feeder.stamps().size(), 200U);
  EXPECT_EQ(feeder.counts().dropped, 0U);
}

TEST(FrameFeeder, AStopEndsASourceThatWaitsForItsCamera) {
  class WaitingSource final : public FrameSource {
   public:
    SourceDescription describe() const override { return {}; }
    std::optional<SensorFrame> next() override {
      while (!is_interrupted()) std::this_thread::sleep_for(1ms);
      return std::nullopt;
    }
  } source;
  FrameFeeder feeder(source, {});
  feeder.stop();
  EXPECT_FALSE(feeder.next()) << "a feeder whose source never ends would wait for it when it is destroyed";
}

TEST(FrameFeeder, FingerprintsTellRepeatedImages) {
  class Images final : public FrameSource {
   public:
    SourceDescription describe() const override { return {}; }
    std::optional<SensorFrame> next() override {
      if (index_ == 4) return std::nullopt;
      SensorFrame frame;
      frame.timestamp = static_cast<double>(index_);
      frame.colour = cv::Mat(6, 8, CV_8UC3, cv::Scalar::all(7));
      if (index_ < 3) frame.colour.at<cv::Vec3b>(5, 7)[2] = index_ < 2 ? 1 : 2;
      frame.index = index_++;
      return frame;
    }

   private:
    std::uint64_t index_ = 0;
  } source;
  FrameFeeder feeder(source, {});
  std::vector<std::uint64_t> fingerprints;
  while (const auto fed = feeder.next()) fingerprints.push_back(fed->fingerprint);
  ASSERT_EQ(fingerprints.size(), 4U);
  EXPECT_NE(fingerprints[0], 0U);
  EXPECT_EQ(fingerprints[1], fingerprints[0]);
  EXPECT_NE(fingerprints[2], fingerprints[0]);
  EXPECT_EQ(fingerprints[3], 0U) << "an image without any content is like no other";
}

TEST(FrameFeeder, AnErrorOfTheSourceComesAfterTheFramesBeforeIt) {
  CountingSource source(10, 3);
  FrameFeeder feeder(source, {});
  for (std::uint64_t i = 0; i < 3; ++i) EXPECT_EQ(feeder.next()->frame.index, i);
  EXPECT_THROW(feeder.next(), InputError);
  EXPECT_FALSE(feeder.next());
}

TEST(FrameFeeder, PacedFramesDoNotComeBeforeTheirTime) {
  CountingSource source(6);
  const Stopwatch since_start;  // before the first frame is due, however busy the machine is
  FrameFeeder feeder(source, {.pace = Pace::timestamps});
  while (const auto fed = feeder.next()) EXPECT_GE(since_start.seconds(), fed->frame.timestamp);
}

TEST(FrameFeeder, ASlowTrackerCostsFramesOrTime) {
  const auto taken = [](LateFrames late) {
    CountingSource source(20);
    FrameFeeder feeder(source, {.pace = Pace::timestamps, .late_frames = late, .frame_queue = 2});
    std::size_t count = 0;
    std::uint64_t last = 0;
    while (const auto fed = feeder.next()) {
      std::this_thread::sleep_for(30ms);
      ++count;
      EXPECT_TRUE(count == 1 || fed->frame.index > last);
      last = fed->frame.index;
    }
    EXPECT_EQ(count + feeder.counts().dropped, 20U);
    EXPECT_EQ(last, 19U);  // the newest is never the one that goes
    return count;
  };
  EXPECT_LT(taken(LateFrames::drop), 20U);
  EXPECT_EQ(taken(LateFrames::queue), 20U);
}

/// Takes three times as long for a frame as there is, and knows the stamps of those to come.
class SlowSource final : public FrameSource {
 public:
  static constexpr std::uint64_t count = 60;
  explicit SlowSource(bool knows_stamps) : knows_stamps_(knows_stamps) {}
  SourceDescription describe() const override { return {}; }
  std::optional<SensorFrame> next() override {
    if (index_ == count) return std::nullopt;
    std::this_thread::sleep_for(30ms);
    SensorFrame frame;
    frame.timestamp = stamp(index_);
    frame.index = index_++;
    return frame;
  }
  std::vector<double> pass_over(double timestamp) override {
    std::vector<double> stamps;
    if (!knows_stamps_) return stamps;
    for (; index_ + 1 < count && stamp(index_ + 1) <= timestamp; ++index_) stamps.push_back(stamp(index_));
    return stamps;
  }

 private:
  static double stamp(std::uint64_t index) { return 0.01 * static_cast<double>(index); }
  bool knows_stamps_;
  std::uint64_t index_ = 0;
};

TEST(FrameFeeder, ASlowReaderCostsFramesWhereTheyMayBeDropped) {
  const auto dropped = [](LateFrames late, bool knows_stamps) {
    SlowSource source(knows_stamps);
    FrameFeeder feeder(source, {.pace = Pace::timestamps, .late_frames = late});
    std::uint64_t count = 0, last = 0;
    while (const auto fed = feeder.next()) {
      EXPECT_TRUE(count == 0 || fed->frame.index > last);
      ++count;
      last = fed->frame.index;
    }
    EXPECT_EQ(last, SlowSource::count - 1) << "the newest is never dropped";
    const std::vector<double> stamps = feeder.stamps();
    EXPECT_EQ(stamps.size(), SlowSource::count);
    EXPECT_TRUE(std::is_sorted(stamps.begin(), stamps.end()));
    EXPECT_EQ(count + feeder.counts().dropped, SlowSource::count);
    return feeder.counts().dropped;
  };
  EXPECT_GE(dropped(LateFrames::drop, true), SlowSource::count / 3);
  EXPECT_EQ(dropped(LateFrames::queue, true), 0U);
  dropped(LateFrames::drop, false);
}

/// A frame an hour.
class FarSource final : public FrameSource {
 public:
  SourceDescription describe() const override { return {}; }
  std::optional<SensorFrame> next() override {
    SensorFrame frame;
    frame.timestamp = 3600.0 * static_cast<double>(index_);
    frame.index = index_++;
    return frame;
  }

 private:
  std::uint64_t index_ = 0;
};

TEST(FrameFeeder, WhoeverWaitsForAFarFrameIsAskedWhetherToStop) {
  FarSource source;
  FrameFeeder feeder(source, {.pace = Pace::timestamps});
  int asked = 0;
  const auto stop = [&] { return ++asked == 3; };
  EXPECT_TRUE(feeder.next([] { return false; }));
  EXPECT_FALSE(feeder.next(stop));
  EXPECT_EQ(asked, 3);
}

TEST(FrameFeeder, StopEndsAWaitForAFarFrame) {
  FarSource source;
  FrameFeeder feeder(source, {.pace = Pace::timestamps});
  EXPECT_TRUE(feeder.next());
  auto next = std::async(std::launch::async, [&] { return feeder.next().has_value(); });
  feeder.stop();
  EXPECT_FALSE(next.get());
}

}  // namespace
}  // namespace holdfast
