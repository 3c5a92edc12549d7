// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>

#include "holdfast/core/camera.hpp"

namespace holdfast {

/// Reads one camera of a sensors.yaml of OpenLORIS-Scene, such as "d400_color_optical_frame": width, height, fps, model
/// (pinhole), intrinsics in the order fx, cx, fy, cy, distortion_model (radial-tangential, Kannala-Brandt, which is
/// that of a fisheye lens, or none) and distortion_coefficients. Throws InputError (file, line and column) for missing
/// or invalid values.
Camera read_openloris_camera(const std::filesystem::path& file, const std::string& sensor);

/// Reads the pose of a sensor on the robot, T_base_sensor, of a trans_matrix.yaml: a tree of rigid motions, each the
/// pose of its child_frame in its parent_frame, which are chained from base_link to the sensor. Throws as
/// read_openloris_camera().
Eigen::Isometry3d read_openloris_pose(const std::filesystem::path& file, const std::string& sensor);

}  // namespace holdfast
