// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "bag.hpp"
#include "holdfast/core/imu_sample.hpp"

namespace holdfast::rosbag_plugin {

/// Type of the messages; its fields are the same in ROS 1 and ROS 2 (wiki.ros.org/sensor_msgs).
inline constexpr const char* imu_type = "sensor_msgs/Imu";

/// Reads a sensor_msgs/Imu: time stamp of the header, angular velocity and linear acceleration, which is the specific
/// force of the raw accelerometer. Orientation and covariances are not used. Throws InputError for a message that is
/// cut short or has a number that is not finite.
ImuSample read_imu_message(const Message& message);

/// The topic of inertial measurements that a source reads. `name`: of the configuration; "none", or empty where it is
/// looked for if `is_wanted`: the only topic of the type. Empty without one. Throws InputError that lists the topics of
/// the type if the one that is named is missing or of another type or encoding, or if there are several.
std::string choose_imu_topic(const Bag& bag, const std::string& name, bool is_wanted);

/// All measurements of a topic in the order of their stamps, which must differ; none for an empty name.
std::vector<ImuSample> read_imu_topic(Bag& bag, const std::string& topic);

}  // namespace holdfast::rosbag_plugin
