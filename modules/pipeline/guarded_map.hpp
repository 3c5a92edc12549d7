// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>
#include <utility>

#include "holdfast/core/map.hpp"
#include "holdfast/core/map_access.hpp"
#include "holdfast/core/map_mutex.hpp"
#include "holdfast/core/thread_annotations.hpp"

namespace holdfast {

/// The map of a pipeline with its two locks (see SharedMap). While threads run, the pipeline reads and writes it
/// through LockedMap only; mapping and loop closing lock it themselves.
class HOLDFAST_CAPABILITY("map") GuardedMap {
 public:
  explicit GuardedMap(Map map) : map_(std::move(map)) {}

  /// For those who acquire the locks themselves.
  SharedMap shared() { return {map_, mutex_, structure_mutex_}; }
  /// Without a lock: in the constructor of the pipeline, and after its threads have ended.
  Map& unshared() { return map_; }
  const Map& unshared() const { return map_; }

 private:
  friend class LockedMap;
  friend class LockedStructure;

  Map map_;
  MapMutex mutex_;
  std::mutex structure_mutex_;  // SharedMap::structure_mutex
};

/// Who waits for the lock of the map: tracking gets it first.
enum class LockPriority { background, tracking };

/// Holds the lock of the map during its lifetime. A function that needs the lock takes a `const LockedMap&`, or the
/// MapAccess that it is.
class HOLDFAST_SCOPED_CAPABILITY LockedMap : public MapAccess {
 public:
  LockedMap(GuardedMap& map, LockPriority priority) HOLDFAST_ACQUIRE(map) : MapAccess(map.map_), mutex_(map.mutex_) {
    if (priority == LockPriority::tracking)
      mutex_.lock_for_tracking();
    else
      mutex_.lock();
  }
  ~LockedMap() HOLDFAST_RELEASE() { mutex_.unlock(); }

 private:
  MapMutex& mutex_;
};

/// Holds the structure mutex during its lifetime: no other thread moves or removes keyframes and points. Acquired
/// before LockedMap if both are.
class LockedStructure {
 public:
  explicit LockedStructure(GuardedMap& map) : lock_(map.structure_mutex_) {}

 private:
  std::lock_guard<std::mutex> lock_;
};

}  // namespace holdfast
