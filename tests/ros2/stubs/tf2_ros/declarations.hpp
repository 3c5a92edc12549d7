// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <geometry_msgs/msg/transform_stamped.hpp>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace tf2 {
using TimePoint = std::chrono::time_point<std::chrono::system_clock, std::chrono::nanoseconds>;
using Duration = std::chrono::nanoseconds;
constexpr TimePoint TimePointZero = TimePoint(Duration::zero());
Duration durationFromSec(double t_sec);
class TransformException : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
class LookupException : public TransformException {
 public:
  using TransformException::TransformException;
};
}  // namespace tf2

namespace tf2_ros {

tf2::TimePoint fromMsg(const builtin_interfaces::msg::Time& time_msg);

class Buffer {
 public:
  explicit Buffer(rclcpp::Clock::SharedPtr clock);
  geometry_msgs::msg::TransformStamped lookupTransform(const std::string& target_frame, const std::string& source_frame,
                                                       const tf2::TimePoint& time) const;
  geometry_msgs::msg::TransformStamped lookupTransform(const std::string& target_frame, const std::string& source_frame,
                                                       const tf2::TimePoint& time, tf2::Duration timeout) const;
};
class TransformListener {
 public:
  explicit TransformListener(Buffer& buffer, bool spin_thread = true);
};
class TransformBroadcaster {
 public:
  template <class NodeT>
  explicit TransformBroadcaster(NodeT&& node);
  void sendTransform(const geometry_msgs::msg::TransformStamped& transform);
  void sendTransform(const std::vector<geometry_msgs::msg::TransformStamped>& transforms);
};
class StaticTransformBroadcaster {
 public:
  template <class NodeT>
  explicit StaticTransformBroadcaster(NodeT&& node);
  void sendTransform(const geometry_msgs::msg::TransformStamped& transform);
};

}  // namespace tf2_ros
