// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "holdfast/dense_map/kept_view.hpp"
#include "holdfast/surface/surface_field.hpp"

namespace holdfast {

/// A surface that follows the poses of its views: views whose pose was adjusted by more than a voxel are taken out of
/// the field and put in again (Dai et al., BundleFusion, TOG 2017). Used by one thread.
class SurfaceMap {
 public:
  /// `camera` is the pinhole camera of the views, but for those that only carve.
  SurfaceMap(const Camera& camera, const SurfaceSettings& settings) : camera_(camera), field_(camera, settings) {}

  /// Makes the field that of these views, by increasing frame index, and of their poses T_world_camera: takes out views
  /// that are missing, puts in new ones, and moves those that were adjusted, those with the largest motion first and at
  /// most `max_moves`. Returns the number of views that remain to be moved.
  std::size_t update(const std::vector<KeptView>& views, const std::vector<Eigen::Isometry3d>& poses,
                     std::size_t max_moves);

  const SurfaceField& field() const { return field_; }
  const Camera& camera() const { return camera_; }
  std::size_t view_count() const { return entries_.size(); }
  /// Number of the views that do not only carve: keyframes, and frames between them.
  std::size_t fused_view_count() const;
  /// The views that are fused, by increasing frame index, and those that only carve.
  const KeptView& view(std::size_t number) const { return entries_[number].view; }
  /// T_world_camera with which a view is fused.
  const Eigen::Isometry3d& pose(std::size_t number) const { return entries_[number].fusion.T_world_camera; }
  /// Memory of the field and of the images of the views.
  std::size_t memory_bytes() const;
  /// Number of times that a view was fused again at another pose.
  std::size_t move_count() const { return moves_; }

 private:
  struct Entry {
    KeptView view;
    SurfaceField::Fusion fusion;
  };
  /// Largest motion of what a view observes, between two poses [m].
  double motion(const Eigen::Isometry3d& before, const Eigen::Isometry3d& after) const;

  Camera camera_;
  SurfaceField field_;
  std::vector<Entry> entries_;  // by frame index
  std::uint32_t next_number_ = 0;
  std::size_t moves_ = 0;
};

}  // namespace holdfast
