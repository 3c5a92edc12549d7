// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/surface/surface_views.hpp"

namespace holdfast {

/// The free space that the views of a surface looked through, by their depth images: also of pixels that were excluded
/// as dynamic. Immutable after construction; any thread.
class ObservedSpace {
 public:
  /// The views are at the poses of the map.
  ObservedSpace(SurfaceViews views, const Map& map);

  /// Whether a view looked through a point up to SurfaceSettings::maximum_depth: all depths of the 3x3 pixels around it
  /// are larger by the truncation and by 4 cm plus 1 % of the squared depth, as where SurfaceField carves.
  bool is_free(const Eigen::Vector3d& point) const;

 private:
  bool looks_through(const KeptView& view, const Eigen::Vector3d& point_in_camera) const;

  SurfaceViews views_;
  std::vector<Eigen::Isometry3d> T_camera_world_;
};

}  // namespace holdfast
