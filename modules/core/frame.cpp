// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/frame.hpp"

namespace holdfast {

Eigen::Isometry3d Frame::T_world_camera() const { return T_camera_world.inverse(); }

Eigen::Isometry3d Frame::T_view_world() const { return coarse.T_view_world(T_camera_world); }

}  // namespace holdfast
