// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "holdfast/core/stage_times.hpp"
#include "holdfast/core/worker_counts.hpp"

namespace holdfast {

/// First-in, first-out queue between threads with a bounded length. Waits without spinning.
template <class T>
class BoundedQueue {
 public:
  explicit BoundedQueue(std::size_t capacity) { counts_.capacity = std::max<std::size_t>(capacity, 1); }

  /// Adds a value, waiting while the queue is full. Returns false and discards the value when the queue is closed.
  bool push(T value) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || has_room_unlocked(); });
    return add(std::move(value));
  }
  /// Adds a value without waiting; a full queue drops its oldest value.
  bool push_newest(T value) {
    const std::lock_guard lock(mutex_);
    if (!closed_ && !has_room_unlocked()) {
      entries_.pop_front();
      ++counts_.dropped;
    }
    return add(std::move(value));
  }

  /// Waits for a value; returns nothing when the queue is closed and empty.
  std::optional<T> pop() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !entries_.empty(); });
    return take(lock);
  }
  /// Waits like pop(), and calls waits_on() ten times a second; returns nothing when that returns false.
  template <class WaitsOn>
  std::optional<T> pop_while(const WaitsOn& waits_on) {
    std::unique_lock lock(mutex_);
    while (!changed_.wait_for(lock, std::chrono::milliseconds(100), [this] { return closed_ || !entries_.empty(); })) {
      lock.unlock();
      if (!waits_on()) return std::nullopt;
      lock.lock();
    }
    return take(lock);
  }

  bool has_room() const {
    const std::lock_guard lock(mutex_);
    return has_room_unlocked();
  }
  /// Waits until a value can be added or the queue is closed.
  void wait_for_room() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || has_room_unlocked(); });
  }
  /// Accepts no more values; queued ones can still be popped unless `abandon`. Wakes all waiting threads.
  void close(bool abandon = false) {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
      if (abandon) entries_.clear();
    }
    changed_.notify_all();
  }
  QueueCounts counts() const {
    const std::lock_guard lock(mutex_);
    return counts_;
  }

 private:
  struct Entry {
    T value;
    Stopwatch since;
  };
  bool has_room_unlocked() const { return entries_.size() < counts_.capacity; }
  /// Returns the oldest value, if there is one, and releases the lock.
  std::optional<T> take(std::unique_lock<std::mutex>& lock) {
    if (entries_.empty()) return std::nullopt;
    Entry entry = std::move(entries_.front());
    entries_.pop_front();
    const double waited = entry.since.seconds();
    ++counts_.taken;
    counts_.wait_total += waited;
    counts_.wait_longest = std::max(counts_.wait_longest, waited);
    lock.unlock();
    changed_.notify_all();
    return std::move(entry.value);
  }
  bool add(T value) {
    if (closed_) return false;
    entries_.push_back({std::move(value), Stopwatch()});
    counts_.longest = std::max(counts_.longest, entries_.size());
    changed_.notify_all();
    return true;
  }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Entry> entries_;
  bool closed_ = false;
  QueueCounts counts_;
};

}  // namespace holdfast
