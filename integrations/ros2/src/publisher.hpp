// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <geometry_msgs/msg/pose_with_covariance_stamped.hpp>
#include <geometry_msgs/msg/transform_stamped.hpp>
#include <memory>
#include <mutex>
#include <nav_msgs/msg/occupancy_grid.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <nav_msgs/msg/path.hpp>
#include <octomap_msgs/msg/octomap.hpp>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>
#include <string>
#include <visualization_msgs/msg/marker_array.hpp>

#include "holdfast/bridge/bridge.hpp"
#include "node_parameters.hpp"
#include "tf2_headers.hpp"

namespace holdfast_ros {

namespace bridge = holdfast::bridge;

builtin_interfaces::msg::Time time_of(bridge::Stamp stamp);
bridge::Stamp stamp_of(const builtin_interfaces::msg::Time& time);

/// Publishes what the bridge finds; messages are handed over, so that nodes of the same process get no copies.
class Publisher final : public bridge::Listener {
 public:
  /// All must outlive the object.
  Publisher(rclcpp_lifecycle::LifecycleNode& node, const NodeParameters& parameters, const tf2_ros::Buffer& transforms);

  void on_frame(const bridge::FrameOutput& frame) override;
  void on_map(const bridge::MapOutput& map) override;
  void on_grid(const bridge::GridOutput& grid) override;
  void on_message(bridge::Diagnostics::Level level, const std::string& text) override;
  std::optional<Eigen::Isometry3d> odometry(bridge::Stamp stamp) override;

  void publish_diagnostics(const bridge::Diagnostics& diagnostics);
  /// Publishes the pose of the camera on the robot for those who look for it, where tf has none.
  void publish_camera(const Eigen::Isometry3d& T_base_camera, const std::string& camera_frame);
  /// The frame of the colour images.
  void set_camera_frame(const std::string& frame);

 private:
  template <class Message>
  using Out = std::shared_ptr<rclcpp_lifecycle::LifecyclePublisher<Message>>;
  void publish_transforms(const bridge::FrameOutput& frame);
  void publish_odometry(const bridge::FrameOutput& frame);
  void publish_obstacles(const bridge::FrameOutput& frame, const std_msgs::msg::Header& header);
  std::string camera_frame() const;

  static constexpr const char* octree_frame = "holdfast_world";
  rclcpp_lifecycle::LifecycleNode& node_;
  const NodeParameters& parameters_;
  const tf2_ros::Buffer& transforms_;
  Out<geometry_msgs::msg::PoseWithCovarianceStamped> pose_;
  Out<nav_msgs::msg::Odometry> odometry_;
  Out<sensor_msgs::msg::PointCloud2> obstacles_;
  Out<visualization_msgs::msg::MarkerArray> markers_;
  Out<sensor_msgs::msg::Image> mask_;
  Out<nav_msgs::msg::Path> path_;
  Out<sensor_msgs::msg::PointCloud2> points_;
  Out<nav_msgs::msg::OccupancyGrid> grid_;
  Out<octomap_msgs::msg::Octomap> octomap_;
  Out<diagnostic_msgs::msg::DiagnosticArray> diagnostics_;
  tf2_ros::TransformBroadcaster broadcaster_;
  tf2_ros::StaticTransformBroadcaster static_broadcaster_;
  bool has_markers_ = false;
  mutable std::mutex mutex_;
  std::string camera_frame_;  // guarded by mutex_
};

}  // namespace holdfast_ros
