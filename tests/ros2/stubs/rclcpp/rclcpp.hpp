// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <builtin_interfaces/msg/time.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

enum rcl_clock_type_t { RCL_ROS_TIME = 1, RCL_SYSTEM_TIME, RCL_STEADY_TIME };
struct rmw_qos_profile_t {
  std::size_t depth;
};
extern const rmw_qos_profile_t rmw_qos_profile_default;
extern const rmw_qos_profile_t rmw_qos_profile_sensor_data;

namespace rclcpp {

class Time {
 public:
  explicit Time(std::int64_t nanoseconds = 0, rcl_clock_type_t clock = RCL_SYSTEM_TIME);
  Time(const builtin_interfaces::msg::Time& time_msg, rcl_clock_type_t ros_time = RCL_ROS_TIME);  // NOLINT
  operator builtin_interfaces::msg::Time() const;                                                 // NOLINT
  double seconds() const;
};

class QoS {
 public:
  QoS(std::size_t history_depth);  // NOLINT
  QoS& best_effort();
  QoS& transient_local();
};
class SensorDataQoS : public QoS {
 public:
  SensorDataQoS();
};

template <typename MessageT>
class Publisher {
 public:
  using SharedPtr = std::shared_ptr<Publisher>;
  void publish(const MessageT& msg);
  void publish(std::unique_ptr<MessageT> msg);
  std::size_t get_subscription_count() const;
};

class Logger {};

class Node {
 public:
  using SharedPtr = std::shared_ptr<Node>;
  explicit Node(const std::string& node_name);
  virtual ~Node();
  template <typename ParameterT>
  ParameterT declare_parameter(const std::string& name, const ParameterT& default_value);
  template <typename MessageT>
  std::shared_ptr<Publisher<MessageT>> create_publisher(const std::string& topic_name, const QoS& qos);
  Logger get_logger() const;
};

void init(int argc, char const* const* argv);
void spin(Node::SharedPtr node_ptr);
bool shutdown();

/// As printf() checks its arguments.
[[gnu::format(printf, 2, 3)]] void log_warning(const Logger& logger, const char* format, ...);

}  // namespace rclcpp

#define RCLCPP_WARN(logger, ...) ::rclcpp::log_warning(logger, __VA_ARGS__)
