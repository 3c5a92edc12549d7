// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/pipeline/bounded_queue.hpp"
#include "holdfast/pipeline/frame_feeder.hpp"
#include "holdfast/pipeline/worker.hpp"

namespace holdfast {
namespace {

using namespace std::chrono_literals;

TEST(BoundedQueue, KeepsOrderAndCapacity) {
  BoundedQueue<int> queue(2);
  EXPECT_TRUE(queue.push(1));
  EXPECT_TRUE(queue.try_push(2));
  EXPECT_FALSE(queue.has_room());
  EXPECT_FALSE(queue.try_push(3));
  EXPECT_TRUE(queue.push_newest(4));  // 1 makes room
  EXPECT_EQ(queue.pop(), 2);
  EXPECT_EQ(queue.pop(), 4);
  const QueueCounts counts = queue.counts();
  EXPECT_EQ(counts.capacity, 2U);
  EXPECT_EQ(counts.taken, 2U);
  EXPECT_EQ(counts.refused, 1U);
  EXPECT_EQ(counts.dropped, 1U);
  EXPECT_EQ(counts.longest, 2U);
}

TEST(BoundedQueue, ClosedGivesTheRestAndTakesNothing) {
  BoundedQueue<int> queue(3);
  queue.push(1);
  queue.push(2);
  queue.close();
  EXPECT_FALSE(queue.push(3));
  EXPECT_FALSE(queue.push_newest(3));
  EXPECT_EQ(queue.pop(), 1);
  EXPECT_EQ(queue.pop(), 2);
  EXPECT_EQ(queue.pop(), std::nullopt);
  BoundedQueue<int> abandoned(3);
  abandoned.push(1);
  abandoned.close(true);
  EXPECT_EQ(abandoned.pop(), std::nullopt);
}

TEST(BoundedQueue, ClosingWakesThoseWhoWait) {
  BoundedQueue<int> empty(1), full(1);
  full.push(1);
  auto popping = std::async(std::launch::async, [&] { return empty.pop().has_value(); });
  auto pushing = std::async(std::launch::async, [&] { return full.push(2); });
  auto waiting = std::async(std::launch::async, [&] { full.wait_for_room(); });
  std::this_thread::sleep_for(5ms);
  empty.close();
  full.close();
  EXPECT_FALSE(popping.get());
  EXPECT_FALSE(pushing.get());
  waiting.get();
}

TEST(BoundedQueue, NothingIsLostBetweenThreads) {
  BoundedQueue<int> queue(3);
  constexpr int count = 2000;
  std::jthread producer([&] {
    for (int i = 0; i < count; ++i) queue.push(i);
    queue.close();
  });
  int expected = 0;
  while (const std::optional<int> value = queue.pop()) EXPECT_EQ(*value, expected++);
  EXPECT_EQ(expected, count);
  EXPECT_LE(queue.counts().longest, 3U);
}

TEST(Worker, DoesAllItsJobsBeforeItEnds) {
  std::vector<int> done;
  Worker<int> worker("test", 4, [&](int& job) { done.push_back(job); });
  for (int i = 0; i < 50; ++i) worker.queue().push(i);
  worker.finish();
  ASSERT_EQ(done.size(), 50U);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(done[static_cast<std::size_t>(i)], i);
  EXPECT_EQ(worker.counts().queue.taken, 50U);
  EXPECT_EQ(worker.counts().name, "test");
}

TEST(Worker, AnExceptionComesBackAndEndsIt) {
  Worker<int> worker("test", 1, [](int& job) {
    if (job == 1) throw InputError({"job"}, "cannot be done");
  });
  worker.queue().push(0);
  worker.queue().push(1);
  while (worker.queue().push(2)) {
  }  // until the queue is closed
  worker.finish();
  EXPECT_THROW(worker.rethrow(), InputError);
  EXPECT_NO_THROW(worker.rethrow());
}

TEST(Worker, DestructionAbandonsWhatWaits) {
  std::promise<void> begun, go;
  std::atomic<int> done = 0;
  {
    auto worker = std::make_unique<Worker<int>>("test", 10, [&](int& job) {
      if (job == 0) begun.set_value(), go.get_future().wait();
      ++done;
    });
    for (int i = 0; i < 10; ++i) worker->queue().push(i);
    begun.get_future().wait();
    std::jthread release([&] {
      std::this_thread::sleep_for(10ms);
      go.set_value();
    });
    worker.reset();
  }
  EXPECT_EQ(done, 1);
}

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

TEST(FrameFeeder, AnErrorOfTheSourceComesAfterTheFramesBeforeIt) {
  CountingSource source(10, 3);
  FrameFeeder feeder(source, {});
  for (std::uint64_t i = 0; i < 3; ++i) EXPECT_EQ(feeder.next()->frame.index, i);
  EXPECT_THROW(feeder.next(), InputError);
  EXPECT_FALSE(feeder.next());
}

TEST(FrameFeeder, PacedFramesDoNotComeBeforeTheirTime) {
  CountingSource source(6);
  FrameFeeder feeder(source, {.by_timestamps = true});
  feeder.next();
  const Stopwatch since_first;
  while (const auto fed = feeder.next()) {
    constexpr double tolerance = 0.005;  // the first frame was due a little before it was taken here
    EXPECT_GE(since_first.seconds() + tolerance, fed->frame.timestamp);
  }
}

TEST(FrameFeeder, ASlowTrackerCostsFramesOrTime) {
  const auto taken = [](bool drop) {
    CountingSource source(20);
    FrameFeeder feeder(source, {.by_timestamps = true, .drop_late = drop, .frame_queue = 2});
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
  EXPECT_LT(taken(true), 20U);
  EXPECT_EQ(taken(false), 20U);
}

TEST(FrameFeeder, StopEndsAWaitForAFarFrame) {
  class Far final : public FrameSource {
   public:
    SourceDescription describe() const override { return {}; }
    std::optional<SensorFrame> next() override {
      SensorFrame frame;
      frame.timestamp = 3600.0 * static_cast<double>(index_);
      frame.index = index_++;
      return frame;
    }
    std::uint64_t index_ = 0;
  } source;
  FrameFeeder feeder(source, {.by_timestamps = true});
  EXPECT_TRUE(feeder.next());
  auto next = std::async(std::launch::async, [&] { return feeder.next().has_value(); });
  feeder.stop();
  EXPECT_FALSE(next.get());
}

}  // namespace
}  // namespace holdfast
