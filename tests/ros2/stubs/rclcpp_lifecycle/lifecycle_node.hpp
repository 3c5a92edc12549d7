// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <string>

namespace rclcpp_lifecycle {

class State {};

template <typename MessageT>
class LifecyclePublisher {
 public:
  void publish(std::unique_ptr<MessageT> msg);
  void publish(const MessageT& msg);
  std::size_t get_subscription_count() const;
};

namespace node_interfaces {
class LifecycleNodeInterface {
 public:
  enum class CallbackReturn : std::uint8_t { SUCCESS = 97, FAILURE = 98, ERROR = 99 };
  virtual CallbackReturn on_configure(const State& previous_state);
  virtual CallbackReturn on_cleanup(const State& previous_state);
  virtual CallbackReturn on_shutdown(const State& previous_state);
  virtual CallbackReturn on_activate(const State& previous_state);
  virtual CallbackReturn on_deactivate(const State& previous_state);
  virtual CallbackReturn on_error(const State& previous_state);
  virtual ~LifecycleNodeInterface();
};
}  // namespace node_interfaces

class LifecycleNode : public node_interfaces::LifecycleNodeInterface {
 public:
  using CallbackReturn = node_interfaces::LifecycleNodeInterface::CallbackReturn;

  explicit LifecycleNode(const std::string& node_name, const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

  CallbackReturn on_activate(const State& previous_state) override;
  CallbackReturn on_deactivate(const State& previous_state) override;
  const State& configure();
  const State& activate();

  const char* get_name() const;
  rclcpp::Logger get_logger() const;
  rclcpp::Clock::SharedPtr get_clock();
  rclcpp::Time now() const;

  template <typename ParameterT>
  ParameterT declare_parameter(const std::string& name, const ParameterT& default_value);
  template <typename ParameterT>
  bool get_parameter(const std::string& name, ParameterT& parameter) const;
  rclcpp::Parameter get_parameter(const std::string& name) const;
  bool has_parameter(const std::string& name) const;
  std::shared_ptr<rclcpp::node_interfaces::NodeParametersInterface> get_node_parameters_interface();

  rclcpp::CallbackGroup::SharedPtr create_callback_group(rclcpp::CallbackGroupType group_type);
  template <typename MessageT>
  std::shared_ptr<LifecyclePublisher<MessageT>> create_publisher(
      const std::string& topic_name, const rclcpp::QoS& qos,
      const rclcpp::PublisherOptions& options = rclcpp::PublisherOptions());
  template <typename MessageT, typename CallbackT>
  std::shared_ptr<rclcpp::Subscription<MessageT>> create_subscription(const std::string& topic_name,
                                                                      const rclcpp::QoS& qos, CallbackT&& callback,
                                                                      const rclcpp::SubscriptionOptions& options) {
    const std::function<void(std::shared_ptr<const MessageT>)> fits = callback;
    return made<rclcpp::Subscription<MessageT>>(topic_name, qos, fits, options);
  }
  template <typename ServiceT, typename CallbackT>
  std::shared_ptr<rclcpp::Service<ServiceT>> create_service(const std::string& service_name, CallbackT&& callback) {
    const std::function<void(std::shared_ptr<typename ServiceT::Request>, std::shared_ptr<typename ServiceT::Response>)>
        fits = callback;
    return made<rclcpp::Service<ServiceT>>(service_name, fits);
  }
  template <typename Duration>
  rclcpp::TimerBase::SharedPtr create_wall_timer(Duration period, std::function<void()> callback);

 private:
  template <typename Made, typename... Arguments>
  std::shared_ptr<Made> made(const Arguments&... arguments);
};

}  // namespace rclcpp_lifecycle
