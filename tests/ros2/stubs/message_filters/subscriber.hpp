// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rclcpp/version.h>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <string>

namespace message_filters {

template <class M>
class Subscriber {
 public:
  Subscriber() = default;
  Subscriber(const Subscriber&) = delete;
#if RCLCPP_VERSION_GTE(29, 0, 0)
  void subscribe(rclcpp::Node* node, const std::string& topic, const rclcpp::QoS& qos);
#else
  void subscribe(rclcpp::Node* node, const std::string& topic, const rmw_qos_profile_t qos = rmw_qos_profile_default);
#endif
};

}  // namespace message_filters
