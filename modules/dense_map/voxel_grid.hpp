// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/dense_map/static_scene.hpp"

namespace holdfast::dense_map {

/// What was seen in a cube of the world. Views are named by their position in StaticScene::views().
struct Voxel {
  std::uint64_t key = 0;
  float x = 0, y = 0, z = 0;                               ///< sum of the points, from the corner of the voxel [m]
  std::uint32_t blue = 0, green = 0, red = 0, points = 0;  ///< sums
  std::uint16_t views = 0, first_view = 0, last_view = 0;
  std::uint16_t looks_through = 0;       ///< views after first_view that saw something behind it
  std::uint16_t looks_through_last = 0;  ///< of these, since last_view

  bool has_left() const {
    return (looks_through >= 2 && 2 * looks_through > views) ||
           (looks_through_last >= 3 && 4 * looks_through_last > views);
  }
};

/// Voxels by key. Iterating over voxels() gives the order in which they were first seen.
class VoxelGrid {
 public:
  explicit VoxelGrid(double voxel_size);

  std::uint64_t key_of(const Eigen::Vector3d& point) const;
  Eigen::Vector3d corner_of(std::uint64_t key) const;
  /// The voxel, inserted if it does not exist; valid until the next call.
  Voxel& at(std::uint64_t key);
  /// nullptr when nothing was seen there.
  const Voxel* find(std::uint64_t key) const;
  std::vector<Voxel>& voxels() { return voxels_; }
  const std::vector<Voxel>& voxels() const { return voxels_; }

 private:
  std::size_t slot_of(std::uint64_t key) const;
  void grow();

  double size_;
  std::vector<Voxel> voxels_;
  std::vector<std::uint32_t> slots_;  // position in voxels_ plus one; 0 = free
};

/// Poses of a scene's views in a map: T_world_camera.
std::vector<Eigen::Isometry3d> poses_of(const StaticScene& scene, const Map& map);
/// Puts what the views see of the static scene into voxels, and counts the views that look through each voxel that at
/// least `minimum_views` saw.
VoxelGrid fuse(const StaticScene& scene, const std::vector<Eigen::Isometry3d>& poses, int minimum_views);

}  // namespace holdfast::dense_map
