// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <mutex>

namespace holdfast {

/// Guards a Map between threads. Tracking goes first: while it waits, nobody else gets the lock, so that a worker which
/// locks again and again cannot keep a frame waiting. Whoever works in the background holds it for a few milliseconds
/// at most and gives it back before solving anything. Not recursive.
class MapMutex {
 public:
  /// For background work; with std::lock_guard or std::unique_lock.
  void lock() {
    std::unique_lock state(mutex_);
    changed_.wait(state, [this] { return !held_ && trackers_waiting_ == 0; });
    held_ = true;
  }
  /// For tracking; see TrackingLock.
  void lock_for_tracking() {
    std::unique_lock state(mutex_);
    ++trackers_waiting_;
    changed_.wait(state, [this] { return !held_; });
    --trackers_waiting_;
    held_ = true;
  }
  void unlock() {
    {
      const std::lock_guard state(mutex_);
      held_ = false;
    }
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool held_ = false;
  int trackers_waiting_ = 0;
};

/// Holds the lock for tracking as long as it lives.
class TrackingLock {
 public:
  explicit TrackingLock(MapMutex& mutex) : mutex_(mutex) { mutex_.lock_for_tracking(); }
  ~TrackingLock() { mutex_.unlock(); }
  TrackingLock(const TrackingLock&) = delete;
  TrackingLock& operator=(const TrackingLock&) = delete;

 private:
  MapMutex& mutex_;
};

}  // namespace holdfast
