// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/imu.hpp"
#include "holdfast/image_files/image_list.hpp"

namespace holdfast {

/// A camera of a recording in the ASL layout and its pose on the body.
struct EurocCamera {
  Camera camera;
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
};

/// Reads a sensor.yaml of a camera: T_BS, rate_hz, resolution, camera_model (pinhole), intrinsics, distortion_model
/// (radial-tangential, equidistant, which is that of a fisheye lens, or none) and distortion_coefficients; other keys
/// are ignored. Throws InputError (file, line and column) for missing or invalid values.
EurocCamera read_euroc_camera(const std::filesystem::path& file);

/// Reads T_BS of a sensor.yaml: the pose of a sensor on the body. Throws as read_euroc_camera().
Eigen::Isometry3d read_euroc_pose(const std::filesystem::path& file);

/// Reads a sensor.yaml of an IMU: rate_hz, gyroscope_noise_density, gyroscope_random_walk, accelerometer_noise_density,
/// accelerometer_random_walk. T_body_camera is the inverse of T_BS, that is, of a camera at the body's origin. Throws
/// as read_euroc_camera().
ImuCalibration read_euroc_imu(const std::filesystem::path& file);

/// Reads a camera ("cam0") of a camchain.yaml of Kalibr, which the TUM VI data have in place of sensor.yaml: T_cam_imu,
/// resolution, camera_model, intrinsics, distortion_model and distortion_coeffs. The body is the IMU; the frame rate is
/// not set. Throws as read_euroc_camera().
EurocCamera read_kalibr_camera(const std::filesystem::path& file, const std::string& camera);

/// Reads noise and update_rate of an IMU in Kalibr's format. T_body_camera is the identity. Throws as
/// read_euroc_camera().
ImuCalibration read_kalibr_imu(const std::filesystem::path& file);

/// Reads a data.csv of a camera: lines "time stamp [ns],file name", '#' begins a comment. The stamps [s] increase
/// strictly. Throws InputError (file and line) for anything else.
std::vector<ListedImage> read_euroc_image_list(const std::filesystem::path& file);

}  // namespace holdfast
