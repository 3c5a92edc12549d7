// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class Map;

/// Capability to access a map: functions that require the map's lock take a MapAccess as an argument. For a map shared
/// between threads it is created by the object that holds the lock (LockedMap of the pipeline, MapLock of mapping). It
/// can be created from the map directly if no other thread uses the map. Functions that take the `Map&` itself are
/// unaware of threads; their caller has access.
class MapAccess {
 public:
  explicit MapAccess(Map& map) : map_(map) {}
  MapAccess(const MapAccess&) = delete;
  MapAccess& operator=(const MapAccess&) = delete;

  Map& map() const { return map_; }
  Map* operator->() const { return &map_; }

 private:
  Map& map_;
};

}  // namespace holdfast
