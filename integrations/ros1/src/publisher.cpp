// SPDX-License-Identifier: BSD-3-Clause
#include "publisher.hpp"

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/OccupancyGrid.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <ros/console.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>

#include "holdfast/bridge/message_fields.hpp"
#include "octomap_message.hpp"

namespace holdfast_ros {

namespace {

std_msgs::Header header_of(bridge::Stamp stamp, const std::string& frame) {
  std_msgs::Header header;
  header.stamp = time_of(stamp);
  header.frame_id = frame;
  return header;
}

geometry_msgs::TransformStamped transform_message(bridge::Stamp stamp, const std::string& parent,
                                                  const std::string& child, const Eigen::Isometry3d& T_parent_child) {
  geometry_msgs::TransformStamped message;
  message.header = header_of(stamp, parent);
  message.child_frame_id = child;
  bridge::fill_transform(T_parent_child, message.transform);
  return message;
}

sensor_msgs::PointCloud2 cloud_message(const std_msgs::Header& header, const std::vector<Eigen::Vector3f>& points) {
  sensor_msgs::PointCloud2 message;
  message.header = header;
  bridge::fill_cloud(points, message);
  return message;
}

}  // namespace

ros::Time time_of(bridge::Stamp stamp) {
  ros::Time time;
  time.fromNSec(static_cast<std::uint64_t>(std::max<bridge::Stamp>(stamp, 0)));
  return time;
}

bridge::Stamp stamp_of(const ros::Time& time) { return static_cast<bridge::Stamp>(time.toNSec()); }

Publisher::Publisher(ros::NodeHandle& node, const NodeParameters& parameters, const tf2_ros::Buffer& transforms)
    : parameters_(parameters),
      transforms_(transforms),
      name_(node.getNamespace()),
      pose_(node.advertise<geometry_msgs::PoseWithCovarianceStamped>("pose", 10)),
      odometry_(node.advertise<nav_msgs::Odometry>("odometry", 10)),
      obstacles_(node.advertise<sensor_msgs::PointCloud2>("obstacles", 1)),
      markers_(node.advertise<visualization_msgs::MarkerArray>("obstacle_markers", 1)),
      mask_(node.advertise<sensor_msgs::Image>("mask", 1)),
      // Latched: who subscribes later gets the last one.
      path_(node.advertise<nav_msgs::Path>("path", 1, true)),
      points_(node.advertise<sensor_msgs::PointCloud2>("points", 1, true)),
      grid_(node.advertise<nav_msgs::OccupancyGrid>("map", 1, true)),
      octomap_(node.advertise<Octomap>("octomap", 1, true)),
      diagnostics_(ros::NodeHandle().advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 1)) {}

void Publisher::on_frame(const bridge::FrameOutput& frame) {
  if (mask_.getNumSubscribers() > 0 && !frame.mask.empty()) {
    sensor_msgs::Image mask;
    mask.header = header_of(frame.stamp, camera_frame());
    bridge::fill_mask(frame, mask);
    mask_.publish(mask);
  }
  if (!frame.has_pose) return;
  if (parameters_.publishes_tf) publish_transforms(frame);
  const std_msgs::Header header = header_of(frame.stamp, parameters_.map_frame);
  geometry_msgs::PoseWithCovarianceStamped pose;
  pose.header = header;
  bridge::fill_pose_with_covariance(frame.T_map_base, frame.covariance, pose.pose);
  pose_.publish(pose);
  if (!parameters_.has_external_odometry) {
    nav_msgs::Odometry odometry;
    odometry.header = header_of(frame.stamp, parameters_.odom_frame);
    odometry.child_frame_id = parameters_.base_frame;
    bridge::fill_odometry(frame, odometry);
    odometry_.publish(odometry);
  }
  publish_obstacles(frame, header);
}

void Publisher::publish_obstacles(const bridge::FrameOutput& frame, const std_msgs::Header& header) {
  obstacles_.publish(cloud_message(header, bridge::obstacle_points(frame)));
  // Once more without any, so that the last ones vanish.
  if (!frame.obstacles.empty() || has_markers_) {
    visualization_msgs::MarkerArray markers;
    bridge::fill_markers(header, frame, markers);
    markers_.publish(markers);
  }
  has_markers_ = !frame.obstacles.empty();
}

void Publisher::publish_transforms(const bridge::FrameOutput& frame) {
  geometry_msgs::TransformStamped map_to_odom =
      transform_message(frame.stamp, parameters_.map_frame, parameters_.odom_frame, frame.T_map_odom);
  if (parameters_.has_external_odometry) {
    map_to_odom.header.stamp += ros::Duration(parameters_.transform_tolerance);
    broadcaster_.sendTransform(map_to_odom);
    return;
  }
  broadcaster_.sendTransform(
      {map_to_odom, transform_message(frame.stamp, parameters_.odom_frame, parameters_.base_frame, frame.T_odom_base)});
}

void Publisher::on_map(const bridge::MapOutput& map) {
  const auto header_at = [this](bridge::Stamp stamp) { return header_of(stamp, parameters_.map_frame); };
  nav_msgs::Path path;
  path.header = header_at(map.stamp);
  bridge::fill_path(map, header_at, path);
  path_.publish(path);
  points_.publish(cloud_message(path.header, map.points));
}

void Publisher::on_grid(const bridge::GridOutput& grid) {
  if (grid.has_grid) {
    nav_msgs::OccupancyGrid message;
    message.header = header_of(grid.stamp, parameters_.map_frame);
    bridge::fill_grid(grid, message);
    grid_.publish(message);
  }
  // The cells of an octree lie along the axes of its frame.
  if (parameters_.publishes_tf)
    static_broadcaster_.sendTransform(
        transform_message(grid.stamp, parameters_.map_frame, octree_frame, grid.T_map_octree));
  Octomap octomap;
  octomap.header = header_of(grid.stamp, octree_frame);
  bridge::fill_octomap(grid, octomap);
  octomap_.publish(octomap);
}

void Publisher::on_message(bridge::Diagnostics::Level level, const std::string& text) {
  if (level == bridge::Diagnostics::Level::error)
    ROS_ERROR_STREAM(text);
  else if (level == bridge::Diagnostics::Level::warning)
    ROS_WARN_STREAM(text);
  else
    ROS_INFO_STREAM(text);
}

std::optional<Eigen::Isometry3d> Publisher::odometry(bridge::Stamp stamp) {
  if (!parameters_.has_external_odometry) return std::nullopt;
  try {
    return bridge::isometry_of(transforms_
                                   .lookupTransform(parameters_.odom_frame, parameters_.base_frame, time_of(stamp),
                                                    ros::Duration(parameters_.transform_tolerance))
                                   .transform);
  } catch (const tf2::TransformException& error) {
    ROS_WARN_STREAM_THROTTLE(5.0, "no odometry: " << error.what());
    return std::nullopt;
  }
}

void Publisher::publish_diagnostics(const bridge::Diagnostics& diagnostics) {
  diagnostic_msgs::DiagnosticArray message;
  message.header.stamp = ros::Time::now();
  message.status.resize(1);
  bridge::fill_diagnostics(diagnostics, name_, message.status.front());
  diagnostics_.publish(message);
}

void Publisher::publish_camera(const Eigen::Isometry3d& T_base_camera, const std::string& camera_frame) {
  static_broadcaster_.sendTransform(
      transform_message(stamp_of(ros::Time::now()), parameters_.base_frame, camera_frame, T_base_camera));
}

void Publisher::set_camera_frame(const std::string& frame) {
  const std::lock_guard<std::mutex> lock(mutex_);
  camera_frame_ = frame;
}

std::string Publisher::camera_frame() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return camera_frame_;
}

}  // namespace holdfast_ros
