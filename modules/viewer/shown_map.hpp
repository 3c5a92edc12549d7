// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/map_snapshot.hpp"
#include "holdfast/viewer/viewer.hpp"
#include "message.hpp"

namespace holdfast::viewer {

/// The map as browsers are told of it. Everything remembers the version in which it changed last, so that what a
/// browser lacks is found by the version that it has. One thread.
class ShownMap {
 public:
  /// Moves of points and keyframes below this [m] are not worth a message.
  static constexpr double smallest_move = 1e-3;

  /// Takes over a snapshot as `version`, which is larger than every one before.
  void update(const MapSnapshot& map, std::uint64_t version);
  /// Takes over classes of points as `version`. A point may come with a later snapshot.
  void add(std::span<const ViewedClass> classes, std::uint64_t version);
  /// Adds everything that changed after version `since`; 0 = all.
  void describe(std::uint64_t since, Message& message) const;

  std::size_t keyframe_count() const { return keyframe_count_; }
  std::size_t point_count() const { return point_count_; }

  /// T_world_camera of a keyframe; nullptr when it is not in the map.
  const Eigen::Isometry3d* pose(KeyFrameId keyframe) const;
  /// What has to be applied from the left to a pose of the path that was estimated relative to a keyframe, so that it
  /// follows the keyframe. Of a keyframe that is gone, that of the nearest in time. Empty: nothing. Answers for the
  /// last update.
  std::optional<Eigen::Isometry3d> correction(KeyFrameId keyframe, double timestamp) const;
  /// Whether any correction is not empty.
  bool has_corrections() const { return has_corrections_; }

 private:
  struct Point {
    Eigen::Vector3f position;
    float evidence = 0.0F;
    std::uint32_t generation = 0;
    bool exists = false;
    std::uint8_t label = CellMask::unknown;
    std::uint64_t version = 0;
  };
  struct Class {
    std::uint32_t generation = 0;  // of the point
    std::uint8_t label = CellMask::unknown;
  };
  struct KeyFrame {
    Eigen::Isometry3d T_world_camera;
    Eigen::Isometry3d followed;  // the pose that the path follows so far
    std::optional<Eigen::Isometry3d> correction;
    double timestamp = 0.0;
    std::uint32_t generation = 0;
    bool exists = false;
    std::uint64_t version = 0;
  };
  void update_points(const MapSnapshot& map, std::uint64_t version);
  void update_keyframes(const MapSnapshot& map, std::uint64_t version);

  std::vector<Point> points_;        // by slot
  std::vector<Class> classes_;       // by slot, also of points that are not in the map yet
  std::vector<KeyFrame> keyframes_;  // by slot
  std::vector<std::uint32_t> covisibility_, loops_;
  std::uint64_t covisibility_version_ = 0, loops_version_ = 0;
  std::vector<std::pair<double, std::uint32_t>> by_time_;  // time stamps and slots of keyframes
  std::size_t keyframe_count_ = 0, point_count_ = 0;
  bool has_corrections_ = false;
};

}  // namespace holdfast::viewer
