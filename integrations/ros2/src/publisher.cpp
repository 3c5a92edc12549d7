// SPDX-License-Identifier: BSD-3-Clause
#include "publisher.hpp"

#include <utility>

#include "holdfast/bridge/message_fields.hpp"

namespace holdfast_ros {

namespace {

constexpr bridge::Stamp second = 1'000'000'000;

std_msgs::msg::Header header_of(bridge::Stamp stamp, const std::string& frame) {
  std_msgs::msg::Header header;
  header.stamp = time_of(stamp);
  header.frame_id = frame;
  return header;
}

geometry_msgs::msg::TransformStamped transform_message(bridge::Stamp stamp, const std::string& parent,
                                                       const std::string& child,
                                                       const Eigen::Isometry3d& T_parent_child) {
  geometry_msgs::msg::TransformStamped message;
  message.header = header_of(stamp, parent);
  message.child_frame_id = child;
  bridge::fill_transform(T_parent_child, message.transform);
  return message;
}

std::unique_ptr<sensor_msgs::msg::PointCloud2> cloud_message(const std_msgs::msg::Header& header,
                                                             const std::vector<Eigen::Vector3f>& points) {
  auto message = std::make_unique<sensor_msgs::msg::PointCloud2>();
  message->header = header;
  bridge::fill_cloud(points, *message);
  return message;
}

/// Who subscribes later gets the last one.
rclcpp::QoS latched() { return rclcpp::QoS(1).transient_local(); }

/// Until Jazzy, publishers within a process cannot be latched.
rclcpp::PublisherOptions not_within_process() {
  rclcpp::PublisherOptions options;
  options.use_intra_process_comm = rclcpp::IntraProcessSetting::Disable;
  return options;
}

}  // namespace

builtin_interfaces::msg::Time time_of(bridge::Stamp stamp) {
  builtin_interfaces::msg::Time time;
  time.sec = static_cast<std::int32_t>(stamp / second);
  time.nanosec = static_cast<std::uint32_t>(stamp % second);
  return time;
}

bridge::Stamp stamp_of(const builtin_interfaces::msg::Time& time) { return second * time.sec + time.nanosec; }

Publisher::Publisher(rclcpp_lifecycle::LifecycleNode& node, const NodeParameters& parameters,
                     const tf2_ros::Buffer& transforms)
    : node_(node),
      parameters_(parameters),
      transforms_(transforms),
      pose_(node.create_publisher<geometry_msgs::msg::PoseWithCovarianceStamped>("~/pose", 10)),
      odometry_(node.create_publisher<nav_msgs::msg::Odometry>("~/odometry", 10)),
      obstacles_(node.create_publisher<sensor_msgs::msg::PointCloud2>("~/obstacles", 1)),
      markers_(node.create_publisher<visualization_msgs::msg::MarkerArray>("~/obstacle_markers", 1)),
      mask_(node.create_publisher<sensor_msgs::msg::Image>("~/mask", 1)),
      path_(node.create_publisher<nav_msgs::msg::Path>("~/path", latched(), not_within_process())),
      points_(node.create_publisher<sensor_msgs::msg::PointCloud2>("~/points", latched(), not_within_process())),
      grid_(node.create_publisher<nav_msgs::msg::OccupancyGrid>("~/map", latched(), not_within_process())),
      octomap_(node.create_publisher<octomap_msgs::msg::Octomap>("~/octomap", latched(), not_within_process())),
      diagnostics_(node.create_publisher<diagnostic_msgs::msg::DiagnosticArray>("/diagnostics", 1)),
      broadcaster_(node),
      static_broadcaster_(node) {}

void Publisher::on_frame(const bridge::FrameOutput& frame) {
  if (mask_->get_subscription_count() > 0 && !frame.mask.empty()) {
    auto mask = std::make_unique<sensor_msgs::msg::Image>();
    mask->header = header_of(frame.stamp, camera_frame());
    bridge::fill_mask(frame, *mask);
    mask_->publish(std::move(mask));
  }
  if (!frame.has_pose) return;
  if (parameters_.publishes_tf) publish_transforms(frame);
  const std_msgs::msg::Header header = header_of(frame.stamp, parameters_.map_frame);
  auto pose = std::make_unique<geometry_msgs::msg::PoseWithCovarianceStamped>();
  pose->header = header;
  bridge::fill_pose_with_covariance(frame.T_map_base, frame.covariance, pose->pose);
  pose_->publish(std::move(pose));
  if (!parameters_.has_external_odometry) publish_odometry(frame);
  publish_obstacles(frame, header);
}

void Publisher::publish_transforms(const bridge::FrameOutput& frame) {
  if (parameters_.has_external_odometry) {
    const auto ahead = static_cast<bridge::Stamp>(1e9 * parameters_.transform_tolerance);
    broadcaster_.sendTransform(
        transform_message(frame.stamp + ahead, parameters_.map_frame, parameters_.odom_frame, frame.T_map_odom));
    return;
  }
  broadcaster_.sendTransform(
      {transform_message(frame.stamp, parameters_.map_frame, parameters_.odom_frame, frame.T_map_odom),
       transform_message(frame.stamp, parameters_.odom_frame, parameters_.base_frame, frame.T_odom_base)});
}

void Publisher::publish_odometry(const bridge::FrameOutput& frame) {
  auto odometry = std::make_unique<nav_msgs::msg::Odometry>();
  odometry->header = header_of(frame.stamp, parameters_.odom_frame);
  odometry->child_frame_id = parameters_.base_frame;
  bridge::fill_odometry(frame, *odometry);
  odometry_->publish(std::move(odometry));
}

void Publisher::publish_obstacles(const bridge::FrameOutput& frame, const std_msgs::msg::Header& header) {
  obstacles_->publish(cloud_message(header, bridge::obstacle_points(frame)));
  // Once more without any, so that the last ones vanish.
  if (!frame.obstacles.empty() || has_markers_) {
    auto markers = std::make_unique<visualization_msgs::msg::MarkerArray>();
    bridge::fill_markers(header, frame, *markers);
    markers_->publish(std::move(markers));
  }
  has_markers_ = !frame.obstacles.empty();
}

void Publisher::on_map(const bridge::MapOutput& map) {
  const auto header_at = [this](bridge::Stamp stamp) { return header_of(stamp, parameters_.map_frame); };
  auto path = std::make_unique<nav_msgs::msg::Path>();
  path->header = header_at(map.stamp);
  bridge::fill_path(map, header_at, *path);
  points_->publish(cloud_message(path->header, map.points));
  path_->publish(std::move(path));
}

void Publisher::on_grid(const bridge::GridOutput& grid) {
  if (grid.has_grid) {
    auto message = std::make_unique<nav_msgs::msg::OccupancyGrid>();
    message->header = header_of(grid.stamp, parameters_.map_frame);
    bridge::fill_grid(grid, *message);
    grid_->publish(std::move(message));
  }
  // The cells of an octree lie along the axes of its frame.
  if (parameters_.publishes_tf)
    static_broadcaster_.sendTransform(
        transform_message(grid.stamp, parameters_.map_frame, octree_frame, grid.T_map_octree));
  auto octomap = std::make_unique<octomap_msgs::msg::Octomap>();
  octomap->header = header_of(grid.stamp, octree_frame);
  bridge::fill_octomap(grid, *octomap);
  octomap_->publish(std::move(octomap));
}

void Publisher::on_message(bridge::Diagnostics::Level level, const std::string& text) {
  if (level == bridge::Diagnostics::Level::error)
    RCLCPP_ERROR(node_.get_logger(), "%s", text.c_str());
  else if (level == bridge::Diagnostics::Level::warning)
    RCLCPP_WARN(node_.get_logger(), "%s", text.c_str());
  else
    RCLCPP_INFO(node_.get_logger(), "%s", text.c_str());
}

std::optional<Eigen::Isometry3d> Publisher::odometry(bridge::Stamp stamp) {
  if (!parameters_.has_external_odometry) return std::nullopt;
  try {
    return bridge::isometry_of(transforms_
                                   .lookupTransform(parameters_.odom_frame, parameters_.base_frame,
                                                    tf2_ros::fromMsg(time_of(stamp)),
                                                    tf2::durationFromSec(parameters_.transform_tolerance))
                                   .transform);
  } catch (const tf2::TransformException& error) {
    RCLCPP_WARN(node_.get_logger(), "no odometry: %s", error.what());
    return std::nullopt;
  }
}

void Publisher::publish_diagnostics(const bridge::Diagnostics& diagnostics) {
  auto message = std::make_unique<diagnostic_msgs::msg::DiagnosticArray>();
  message->header.stamp = node_.now();
  message->status.resize(1);
  bridge::fill_diagnostics(diagnostics, node_.get_name(), message->status.front());
  diagnostics_->publish(std::move(message));
}

void Publisher::publish_camera(const Eigen::Isometry3d& T_base_camera, const std::string& camera_frame) {
  geometry_msgs::msg::TransformStamped message =
      transform_message(0, parameters_.base_frame, camera_frame, T_base_camera);
  message.header.stamp = node_.now();
  static_broadcaster_.sendTransform(message);
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
