// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <utility>
#include <vector>

/// What a robot's middleware exchanges with the bridge. This header and bridge.hpp are C++17, which the messages of
/// ROS 1 in Debian 12 require; they include no other header of Holdfast.
namespace holdfast::bridge {

/// Time stamp of a message [ns]. Outputs have exactly the stamps of the colour images that they belong to.
using Stamp = std::int64_t;

/// An image as sensor_msgs/Image describes it. The pixels are read during the call only.
struct RawImage {
  Stamp stamp = 0;
  std::uint32_t width = 0, height = 0;
  std::string encoding;  ///< colour: rgb8, bgr8, rgba8, bgra8, mono8, 8UC1, 8UC3; depth: 16UC1, mono16, 32FC1
  bool is_big_endian = false;
  std::size_t step = 0;  ///< bytes from row to row
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;  ///< [bytes]
};

/// An image as sensor_msgs/CompressedImage describes it: JPEG or PNG, or depth as PNG of 16 bits by
/// compressed_depth_image_transport. The bytes are read during the call only.
struct CompressedImage {
  Stamp stamp = 0;
  std::string format;
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;  ///< [bytes]
};

/// A calibration as sensor_msgs/CameraInfo describes it.
struct CameraInfo {
  std::uint32_t width = 0, height = 0;
  std::string distortion_model;  ///< plumb_bob, rational_polynomial, equidistant, or empty without distortion
  std::vector<double> D;
  std::array<double, 9> K{};
  std::array<double, 12> P{};
  std::uint32_t binning_x = 0, binning_y = 0;
};

/// An inertial measurement, in the axes of the IMU.
struct InertialSample {
  Stamp stamp = 0;
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< [rad/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();      ///< specific force [m/s^2]
};

/// An object that moves or has moved, in the frame `map`.
struct Obstacle {
  std::uint32_t id = 0;  ///< from 1; never reused
  std::string class_name;
  Eigen::Isometry3d T_map_box = Eigen::Isometry3d::Identity();  ///< pose of the centre of its bounding box
  Eigen::Vector3d size = Eigen::Vector3d::Zero();               ///< of the box [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();           ///< [m/s]
  bool is_moving = false;                                       ///< now; otherwise it is at rest after a motion
};

/// What follows from one frame. Frames are those of REP 103 and 105: `map`, `odom`, and `base`, the robot.
struct FrameOutput {
  Stamp stamp = 0;
  bool has_pose = false;  ///< the frame was lost otherwise, and only stamp, state, mask and latency are valid
  std::string state;      ///< name of the HealthState
  /// T_map_odom changes where the map was corrected or the place recognised after a loss; T_odom_base is continuous.
  Eigen::Isometry3d T_map_odom = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_odom_base = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
  /// Covariance of T_map_base as geometry_msgs/PoseWithCovariance has it: position, then rotation about the fixed axes
  /// of `map` [m, rad]. Zero if unknown.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  /// Linear [m/s] and angular [rad/s] velocity in the frame `base`; zero for the first pose and after a jump.
  Eigen::Matrix<double, 6, 1> velocity = Eigen::Matrix<double, 6, 1>::Zero();
  std::vector<Obstacle> obstacles;
  cv::Mat mask;          ///< 8UC1 of the size of the colour image, 255 = can move or moves; empty without a mask
  double latency = 0.0;  ///< from the arrival of the last image of the frame to this output [s]
};

/// The map as poses and points, in the frame `map`.
struct MapOutput {
  Stamp stamp = 0;                                             ///< of the last frame
  std::vector<std::pair<Stamp, Eigen::Isometry3d>> keyframes;  ///< T_map_base, oldest first
  std::vector<Eigen::Vector3f> points;                         ///< those that are not rather moving [m]
};

/// The floor as a grid and the room as an octree.
struct GridOutput {
  Stamp stamp = 0;        ///< of the last frame
  bool has_grid = false;  ///< a floor was found; otherwise only the octree is valid
  /// Pose of the lower left corner of cell (0, 0). It is level if `map` is, to which the pose of the camera on the
  /// robot leads; the axes of the grid are those of `map` then.
  Eigen::Isometry3d T_map_grid = Eigen::Isometry3d::Identity();
  std::uint32_t width = 0, height = 0;
  double resolution = 0.0;          ///< [m]
  std::vector<std::int8_t> cells;   ///< row by row: 0 = free, 100 = occupied, -1 = unknown
  std::vector<std::int8_t> octree;  ///< as octomap_msgs/Octomap has it: binary, id OcTree
  Eigen::Isometry3d T_map_octree = Eigen::Isometry3d::Identity();
};

/// State of the bridge as diagnostic_msgs/DiagnosticStatus has it.
struct Diagnostics {
  enum class Level : std::uint8_t { ok = 0, warning = 1, error = 2 };
  Level level = Level::ok;
  std::string message;
  std::vector<std::pair<std::string, std::string>> values;
};

}  // namespace holdfast::bridge
