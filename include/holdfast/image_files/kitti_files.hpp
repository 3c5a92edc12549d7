// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "holdfast/core/error.hpp"

namespace holdfast {

/// A 3x4 projection matrix K [I | t] of a rectified camera of the KITTI odometry data (Geiger et al. 2013, section
/// IV-C): a point of the reference camera's frame [m] to a pixel.
using KittiProjection = Eigen::Matrix<double, 3, 4>;

/// Throws InputError at `place` for a matrix that is not the projection of a rectified camera.
void require_rectified_projection(const SourceLocation& place, const KittiProjection& matrix);

/// Reads the lines "P0: ..." to "P3: ..." of a calib.txt, or lines of twelve numbers without a name, in their order.
/// Lines with other names (Tr) are ignored. Throws InputError (file and line) for a line with another count of numbers,
/// a matrix that is not the projection of a rectified camera, and a file with fewer than `least`.
std::vector<KittiProjection> read_kitti_calibration(const std::filesystem::path& file, std::size_t least = 2);

/// Reads lines of the twelve numbers of a 3x4 matrix: T_world_camera of each frame, row by row. Rotations are made
/// orthonormal. Throws InputError (file and line) for anything else.
std::vector<Eigen::Isometry3d> read_kitti_poses(const std::filesystem::path& file);

}  // namespace holdfast
