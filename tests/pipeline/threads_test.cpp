// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include "holdfast/core/bounded_queue.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/worker.hpp"

namespace holdfast {
namespace {

using namespace std::chrono_literals;

TEST(BoundedQueue, KeepsOrderAndCapacity) {
  BoundedQueue<int> queue(2);
  EXPECT_TRUE(queue.push(1));
  EXPECT_TRUE(queue.push(2));
  EXPECT_FALSE(queue.has_room());
  EXPECT_TRUE(queue.push_newest(4));  // 1 makes room
  EXPECT_EQ(queue.pop(), 2);
  EXPECT_EQ(queue.pop(), 4);
  const QueueCounts counts = queue.counts();
  EXPECT_EQ(counts.capacity, 2U);
  EXPECT_EQ(counts.taken, 2U);
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

}  // namespace
}  // namespace holdfast
