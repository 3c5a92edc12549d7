// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/coarse_view.hpp"
#include "holdfast/surface/surface_field.hpp"

namespace holdfast {

/// Aligns the coarse depth of a frame with a field: the pose T_view_world that minimises the squared distances of the
/// measured points by the field, by Gauss-Newton on the field's gradient (Bylow et al., RSS 2013, equations 14 to 20),
/// with Huber's cost over the deviation of the depth (depth_noise::alignment_deviation()), and the predicted pose as
/// initial value and as a prior for directions that the surface leaves open.
///
/// Cells that move by CoarseView::static_log_odds do not count, nor do those farther from the surface than its
/// truncation: people before it. Empty unless enough cells lie on the surface, and most of those near it.
/// `camera` is that of the frame, whose undistorted pixels the grid of the view covers. About 2 ms at 640x480. Not
/// while the field changes, and one thread at a time.
std::optional<Eigen::Isometry3d> align_with_surface(const SurfaceField& field, const CoarseView& view,
                                                    const Camera& camera, const Eigen::Isometry3d& T_view_world);

}  // namespace holdfast
