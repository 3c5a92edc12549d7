// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <builtin_interfaces/msg/time.hpp>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

namespace rclcpp {

class Time {
 public:
  operator builtin_interfaces::msg::Time() const;  // NOLINT
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

class Logger {};
class Clock {
 public:
  using SharedPtr = std::shared_ptr<Clock>;
};
class NodeOptions {};
class ParameterValue {};
class Parameter {
 public:
  std::string as_string() const;
};

enum class CallbackGroupType { MutuallyExclusive, Reentrant };
class CallbackGroup {
 public:
  using SharedPtr = std::shared_ptr<CallbackGroup>;
};
struct SubscriptionOptions {
  CallbackGroup::SharedPtr callback_group;
};
enum class IntraProcessSetting { Enable, Disable, NodeDefault };
struct PublisherOptions {
  IntraProcessSetting use_intra_process_comm = IntraProcessSetting::NodeDefault;
};
class SubscriptionBase {
 public:
  using SharedPtr = std::shared_ptr<SubscriptionBase>;
};
template <typename MessageT>
class Subscription : public SubscriptionBase {};
class ServiceBase {
 public:
  using SharedPtr = std::shared_ptr<ServiceBase>;
};
template <typename ServiceT>
class Service : public ServiceBase {};
class TimerBase {
 public:
  using SharedPtr = std::shared_ptr<TimerBase>;
  void cancel();
};

namespace node_interfaces {
class NodeParametersInterface {
 public:
  const std::map<std::string, ParameterValue>& get_parameter_overrides() const;
};
}  // namespace node_interfaces

/// As printf() checks its arguments.
[[gnu::format(printf, 2, 3)]] void log(const Logger& logger, const char* format, ...);

}  // namespace rclcpp

#define RCLCPP_INFO(logger, ...) ::rclcpp::log(logger, __VA_ARGS__)
#define RCLCPP_WARN(logger, ...) ::rclcpp::log(logger, __VA_ARGS__)
#define RCLCPP_ERROR(logger, ...) ::rclcpp::log(logger, __VA_ARGS__)
