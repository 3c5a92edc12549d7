// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class Map;

/// Shows that the caller may use a map that other threads use as well: functions that need the map's lock take one, and
/// what they call works within it. Where threads share the map, it is an object that holds the lock (LockedMap of the
/// pipeline, MapLock of mapping); a MapAccess made of the map itself is for a map that no other thread uses. Functions
/// that are given the `Map&` itself know of no threads: who calls them has access.
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
