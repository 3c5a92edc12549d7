// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "holdfast/bridge/messages.hpp"

/// Between the structs of the bridge and the messages of ROS 1 and ROS 2, whose fields have the same names: templates
/// that need no header of either. Headers of messages are set by the caller, who knows the type of a time stamp.
namespace holdfast::bridge {

/// sensor_msgs/Image. The message must outlive the result.
template <class Message>
RawImage raw_image(const Message& message, Stamp stamp) {
  RawImage image;
  image.stamp = stamp;
  image.width = message.width, image.height = message.height;
  image.encoding = message.encoding;
  image.is_big_endian = message.is_bigendian != 0;
  image.step = message.step;
  image.data = message.data.data(), image.size = message.data.size();
  return image;
}

/// sensor_msgs/CompressedImage. The message must outlive the result.
template <class Message>
CompressedImage compressed_image(const Message& message, Stamp stamp) {
  CompressedImage image;
  image.stamp = stamp;
  image.format = message.format;
  image.data = message.data.data(), image.size = message.data.size();
  return image;
}

/// sensor_msgs/Imu.
template <class Message>
InertialSample inertial_sample(const Message& message, Stamp stamp) {
  InertialSample sample;
  sample.stamp = stamp;
  const auto &w = message.angular_velocity, &a = message.linear_acceleration;
  sample.angular_velocity = Eigen::Vector3d(w.x, w.y, w.z);
  sample.acceleration = Eigen::Vector3d(a.x, a.y, a.z);
  return sample;
}

/// geometry_msgs/Transform.
template <class Message>
Eigen::Isometry3d isometry_of(const Message& message) {
  const auto& q = message.rotation;
  Eigen::Isometry3d pose(Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized());
  pose.translation() = Eigen::Vector3d(message.translation.x, message.translation.y, message.translation.z);
  return pose;
}

/// geometry_msgs/Point and Vector3.
template <class Message>
void fill_vector(const Eigen::Vector3d& vector, Message& message) {
  message.x = vector.x(), message.y = vector.y(), message.z = vector.z();
}

/// geometry_msgs/Quaternion.
template <class Message>
void fill_rotation(const Eigen::Isometry3d& pose, Message& message) {
  const Eigen::Quaterniond q(pose.linear());
  message.x = q.x(), message.y = q.y(), message.z = q.z(), message.w = q.w();
}

/// geometry_msgs/Pose.
template <class Message>
void fill_pose(const Eigen::Isometry3d& pose, Message& message) {
  fill_vector(pose.translation(), message.position);
  fill_rotation(pose, message.orientation);
}

/// geometry_msgs/Transform.
template <class Message>
void fill_transform(const Eigen::Isometry3d& pose, Message& message) {
  fill_vector(pose.translation(), message.translation);
  fill_rotation(pose, message.rotation);
}

/// geometry_msgs/PoseWithCovariance.
template <class Message>
void fill_pose_with_covariance(const Eigen::Isometry3d& pose, const Eigen::Matrix<double, 6, 6>& covariance,
                               Message& message) {
  fill_pose(pose, message.pose);
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column)
      message.covariance[static_cast<std::size_t>(6 * row + column)] = covariance(row, column);
}

/// nav_msgs/Odometry, without its frames.
template <class Message>
void fill_odometry(const FrameOutput& frame, Message& message) {
  fill_pose_with_covariance(frame.T_odom_base, frame.covariance, message.pose);
  fill_vector(frame.velocity.head<3>(), message.twist.twist.linear);
  fill_vector(frame.velocity.tail<3>(), message.twist.twist.angular);
}

/// sensor_msgs/Image of the mask.
template <class Message>
void fill_mask(const FrameOutput& frame, Message& message) {
  message.encoding = "mono8";
  message.width = static_cast<std::uint32_t>(frame.mask.cols);
  message.height = static_cast<std::uint32_t>(frame.mask.rows);
  message.step = message.width;
  message.data.resize(static_cast<std::size_t>(message.width) * message.height);
  for (int y = 0; y < frame.mask.rows; ++y)
    std::memcpy(&message.data[static_cast<std::size_t>(y) * message.step], frame.mask.ptr(y), message.step);
}

/// sensor_msgs/PointCloud2 with the fields x, y, z.
template <class Message>
void fill_cloud(const std::vector<Eigen::Vector3f>& points, Message& message) {
  using Field = std::decay_t<decltype(message.fields[0])>;
  message.height = 1;
  message.width = static_cast<std::uint32_t>(points.size());
  message.point_step = 3 * sizeof(float);
  message.row_step = message.width * message.point_step;
  message.is_dense = true;
  for (const char* name : {"x", "y", "z"}) {
    Field field;
    field.name = name;
    field.offset = static_cast<std::uint32_t>(message.fields.size() * sizeof(float));
    field.datatype = Field::FLOAT32;
    field.count = 1;
    message.fields.push_back(field);
  }
  message.data.resize(message.row_step);
  for (std::size_t i = 0; i < points.size(); ++i)
    std::memcpy(&message.data[i * message.point_step], points[i].data(), message.point_step);
}

/// Points on the faces of the boxes of the moving objects, at most `step` apart, for the obstacle layer of a costmap.
inline std::vector<Eigen::Vector3f> obstacle_points(const FrameOutput& frame, double step = 0.1) {
  std::vector<Eigen::Vector3f> points;
  for (const Obstacle& obstacle : frame.obstacles) {
    if (!obstacle.is_moving) continue;
    const Eigen::Array3i counts = (obstacle.size.array() / step).ceil().min(50.0).cast<int>().max(1);
    for (int x = 0; x <= counts.x(); ++x)
      for (int y = 0; y <= counts.y(); ++y)
        for (int z = 0; z <= counts.z(); ++z) {
          const Eigen::Array3i place(x, y, z);
          if ((place > 0).all() && (place < counts).all()) continue;
          const Eigen::Vector3d share = place.cast<double>() / counts.cast<double>() - 0.5;
          points.emplace_back((obstacle.T_map_box * share.cwiseProduct(obstacle.size)).cast<float>());
        }
  }
  return points;
}

/// visualization_msgs/Marker of an object: its box.
template <class Message>
void fill_box_marker(const Obstacle& obstacle, Message& message) {
  message.ns = "boxes";
  message.id = static_cast<int>(obstacle.id);
  message.type = Message::CUBE;
  fill_pose(obstacle.T_map_box, message.pose);
  fill_vector(obstacle.size.cwiseMax(0.01), message.scale);
  message.color.r = 1.0F;
  message.color.g = obstacle.is_moving ? 0.3F : 0.8F;
  message.color.a = 0.5F;
}

/// visualization_msgs/Marker of an object: its number, speed and class.
template <class Message>
void fill_text_marker(const Obstacle& obstacle, Message& message) {
  fill_box_marker(obstacle, message);
  message.ns = "names";
  message.type = Message::TEXT_VIEW_FACING;
  message.scale.z = 0.15;
  message.color.r = message.color.g = message.color.b = message.color.a = 1.0F;
  char text[64];
  std::snprintf(text, sizeof(text), "%u %.2f m/s ", static_cast<unsigned>(obstacle.id), obstacle.velocity.norm());
  message.text = text + obstacle.class_name;
}

/// visualization_msgs/MarkerArray, which deletes the markers before it.
template <class Header, class Message>
void fill_markers(const Header& header, const FrameOutput& frame, Message& message) {
  message.markers.resize(1 + 2 * frame.obstacles.size());
  auto& first = message.markers.front();
  first.action = std::decay_t<decltype(first)>::DELETEALL;
  first.pose.orientation.w = 1.0;
  for (std::size_t i = 0; i < frame.obstacles.size(); ++i) {
    fill_box_marker(frame.obstacles[i], message.markers[1 + 2 * i]);
    fill_text_marker(frame.obstacles[i], message.markers[2 + 2 * i]);
  }
  for (auto& marker : message.markers) marker.header = header;
}

/// nav_msgs/Path. `header_of(stamp)` makes the headers of the poses.
template <class MakeHeader, class Message>
void fill_path(const MapOutput& map, const MakeHeader& header_of, Message& message) {
  message.poses.resize(map.keyframes.size());
  for (std::size_t i = 0; i < map.keyframes.size(); ++i) {
    message.poses[i].header = header_of(map.keyframes[i].first);
    fill_pose(map.keyframes[i].second, message.poses[i].pose);
  }
}

/// nav_msgs/OccupancyGrid.
template <class Message>
void fill_grid(const GridOutput& grid, Message& message) {
  message.info.map_load_time = message.header.stamp;
  message.info.resolution = static_cast<float>(grid.resolution);
  message.info.width = grid.width;
  message.info.height = grid.height;
  fill_pose(grid.T_map_grid, message.info.origin);
  message.data = grid.cells;
}

/// octomap_msgs/Octomap, in the frame of GridOutput::T_map_octree.
template <class Message>
void fill_octomap(const GridOutput& grid, Message& message) {
  message.binary = true;
  message.id = "OcTree";
  message.resolution = grid.resolution;
  message.data = grid.octree;
}

/// diagnostic_msgs/DiagnosticStatus.
template <class Message>
void fill_diagnostics(const Diagnostics& diagnostics, const std::string& node, Message& message) {
  using Pair = std::decay_t<decltype(message.values[0])>;
  message.level = static_cast<decltype(message.level)>(diagnostics.level);
  message.name = node + ": visual SLAM";
  message.message = diagnostics.message;
  message.hardware_id = "holdfast";
  for (const auto& value : diagnostics.values) {
    Pair pair;
    pair.key = value.first;
    pair.value = value.second;
    message.values.push_back(pair);
  }
}

}  // namespace holdfast::bridge
