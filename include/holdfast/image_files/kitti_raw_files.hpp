// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <opencv2/core/types.hpp>
#include <vector>

#include "holdfast/image_files/kitti_files.hpp"

namespace holdfast {

/// Calibration of the cameras of the KITTI raw data (Geiger et al. 2013, section III), after rectification.
struct KittiRawCalibration {
  std::filesystem::path file;                                   ///< for errors
  std::vector<KittiProjection> projections;                     ///< P_rect of the cameras 0 to 3
  std::vector<cv::Size> sizes;                                  ///< S_rect of the same: sizes of the rectified images
  Eigen::Matrix3d rectification = Eigen::Matrix3d::Identity();  ///< R_rect of camera 0, from the camera as it is
};

/// Reads P_rect_00 to P_rect_03, S_rect_00 to S_rect_03 and R_rect_00 of a calib_cam_to_cam.txt; other keys are
/// ignored. Throws InputError (file and line) for missing and invalid values.
KittiRawCalibration read_kitti_raw_calibration(const std::filesystem::path& file);

/// Reads R and T [m] of calib_velo_to_cam.txt or calib_imu_to_velo.txt: the transform from the first frame of the name
/// to the second. Throws as read_kitti_raw_calibration().
Eigen::Isometry3d read_kitti_transform(const std::filesystem::path& file);

/// Reads a timestamps.txt: lines "2011-09-26 13:02:25.964389445". Returns seconds since 1970; they increase strictly.
/// Throws InputError (file and line) for anything else.
std::vector<double> read_kitti_stamps(const std::filesystem::path& file);

/// The pose in a packet of the OXTS inertial navigation system.
struct KittiOxts {
  double latitude = 0.0, longitude = 0.0;     ///< [deg]
  double altitude = 0.0;                      ///< [m]
  double roll = 0.0, pitch = 0.0, yaw = 0.0;  ///< [rad]; yaw 0 is east, counterclockwise
};

/// Reads a file of oxts/data, of whose numbers the first six are used. Throws InputError for fewer, for numbers that
/// are not finite, and for a latitude of which the Mercator projection has no image.
KittiOxts read_kitti_oxts(const std::filesystem::path& file);

/// The Mercator projection of the raw data's development kit, scaled to the latitude of the first packet, which is the
/// origin. Axes: east, north, up.
class KittiMercator {
 public:
  explicit KittiMercator(const KittiOxts& first);
  /// T_world_imu.
  Eigen::Isometry3d pose(const KittiOxts& packet) const;

 private:
  Eigen::Vector3d project(const KittiOxts& packet) const;

  double scale_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
};

}  // namespace holdfast
