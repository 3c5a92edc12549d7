// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <future>
#include <mutex>
#include <optional>
#include <utility>

#include "image_pairing.hpp"

namespace holdfast::bridge {

/// Frames and requests for the thread that feeds the pipeline; a request goes before the frames that wait. Any thread.
class FrameQueue {
 public:
  /// `most` frames may wait; 0 = any number.
  explicit FrameQueue(std::size_t most) : most_(most) {}

  void push(ImageSet frame) {
    {
      const std::lock_guard lock(mutex_);
      frames_.push_back(std::move(frame));
      if (most_ > 0 && frames_.size() > most_) frames_.pop_front(), ++dropped_;
    }
    changed_.notify_all();
  }

  /// Lets the thread call `work`, waits for it, and throws what it threw. The thread itself must not call this.
  void request(std::function<void()> work) {
    std::packaged_task<void()> task(std::move(work));
    std::future<void> done = task.get_future();
    {
      const std::lock_guard lock(mutex_);
      requests_.push_back(std::move(task));
    }
    changed_.notify_all();
    done.get();
  }

  /// The next frame, after all requests were done in this thread; nothing when the queue was stopped.
  std::optional<ImageSet> next() {
    std::unique_lock lock(mutex_);
    for (;;) {
      is_busy_ = false;
      changed_.notify_all();
      changed_.wait(lock, [&] { return is_stopped_ || !requests_.empty() || !frames_.empty(); });
      is_busy_ = true;
      if (!requests_.empty()) {
        std::packaged_task<void()> task = std::move(requests_.front());
        requests_.pop_front();
        lock.unlock();
        task();
        lock.lock();
        continue;
      }
      if (is_stopped_) return std::nullopt;
      ImageSet frame = std::move(frames_.front());
      frames_.pop_front();
      return frame;
    }
  }

  /// Waits until the thread has nothing to do.
  void wait_until_idle() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return is_stopped_ || (frames_.empty() && requests_.empty() && !is_busy_); });
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    frames_.clear();
  }
  void stop() {
    {
      const std::lock_guard lock(mutex_);
      is_stopped_ = true;
    }
    changed_.notify_all();
  }
  std::uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  const std::size_t most_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<ImageSet> frames_;
  std::deque<std::packaged_task<void()>> requests_;
  std::uint64_t dropped_ = 0;
  bool is_stopped_ = false;
  bool is_busy_ = true;  // until the thread waits first
};

}  // namespace holdfast::bridge
