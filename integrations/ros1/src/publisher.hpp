// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

#include <mutex>
#include <optional>
#include <string>

#include "holdfast/bridge/bridge.hpp"
#include "node_parameters.hpp"

namespace holdfast_ros {

namespace bridge = holdfast::bridge;

ros::Time time_of(bridge::Stamp stamp);
bridge::Stamp stamp_of(const ros::Time& time);

/// Publishes what the bridge finds.
class Publisher final : public bridge::Listener {
 public:
  /// All must outlive the object.
  Publisher(ros::NodeHandle& node, const NodeParameters& parameters, const tf2_ros::Buffer& transforms);

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
  void publish_transforms(const bridge::FrameOutput& frame);
  void publish_obstacles(const bridge::FrameOutput& frame, const std_msgs::Header& header);
  std::string camera_frame() const;

  static constexpr const char* octree_frame = "holdfast_world";
  const NodeParameters& parameters_;
  const tf2_ros::Buffer& transforms_;
  const std::string name_;
  ros::Publisher pose_, odometry_, obstacles_, markers_, mask_, path_, points_, grid_, octomap_, diagnostics_;
  tf2_ros::TransformBroadcaster broadcaster_;
  tf2_ros::StaticTransformBroadcaster static_broadcaster_;
  bool has_markers_ = false;
  mutable std::mutex mutex_;
  std::string camera_frame_;  // guarded by mutex_
};

}  // namespace holdfast_ros
