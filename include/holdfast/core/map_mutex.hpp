// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <mutex>

#include "holdfast/core/map_access.hpp"

namespace holdfast {

class Map;

/// Protects a Map that is shared between threads. Tracking has priority: while it waits, no other thread acquires the
/// lock, so that a worker that locks repeatedly cannot starve it. A background thread holds the lock for a few
/// milliseconds at most and releases it before it solves an optimization problem. Not recursive.
class MapMutex {
 public:
  /// Locks for background work; used through std::lock_guard or std::unique_lock.
  void lock() {
    std::unique_lock state(mutex_);
    changed_.wait(state, [this] { return !held_ && trackers_waiting_ == 0; });
    held_ = true;
  }
  /// Locks with priority for tracking; used through LockedMap of the pipeline.
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

/// Holds the lock of a shared map during its lifetime, for background work.
class MapLock : public MapAccess {
 public:
  MapLock(Map& map, MapMutex& mutex) : MapAccess(map), lock_(mutex) {}

 private:
  std::lock_guard<MapMutex> lock_;
};

/// A map shared by several threads, and its two locks, which are always acquired in this order:
///
/// 1. `structure_mutex`: held while keyframes and points are moved or removed (refining a keyframe, correcting a loop,
///    applying a full adjustment). Ids that its holder copied from the map stay valid.
/// 2. `mutex`: the map's own lock, held for a few milliseconds and never while solving.
///
/// All three must outlive the user of the struct.
struct SharedMap {
  Map& map;
  MapMutex& mutex;
  std::mutex& structure_mutex;
};

}  // namespace holdfast
