// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <std_msgs/Header.h>

#include <cstdint>
#include <string>
#include <vector>

/// octomap_msgs/Octomap, which Debian 12 does not have: the same name, fields and checksum, so that octomap_server,
/// rviz and MoveIt read it.
namespace holdfast_ros {

struct Octomap {
  std_msgs::Header header;
  bool binary = true;
  std::string id = "OcTree";
  double resolution = 0.0;  ///< [m]
  std::vector<std::int8_t> data;
};

}  // namespace holdfast_ros

namespace ros {
namespace message_traits {

template <>
struct MD5Sum<holdfast_ros::Octomap> {
  static const char* value() { return "9a45536b45c5e409cd49f04bb2d9999f"; }
  static const char* value(const holdfast_ros::Octomap&) { return value(); }
};
template <>
struct DataType<holdfast_ros::Octomap> {
  static const char* value() { return "octomap_msgs/Octomap"; }
  static const char* value(const holdfast_ros::Octomap&) { return value(); }
};
template <>
struct Definition<holdfast_ros::Octomap> {
  static const char* value() {
    return "Header header\nbool binary\nstring id\nfloat64 resolution\nint8[] data\n"
           "================================================================================\n"
           "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
  }
  static const char* value(const holdfast_ros::Octomap&) { return value(); }
};
template <>
struct HasHeader<holdfast_ros::Octomap> : TrueType {};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<holdfast_ros::Octomap> {
  template <typename Stream>
  static void write(Stream& stream, const holdfast_ros::Octomap& message) {
    stream.next(message.header);
    stream.next(static_cast<std::uint8_t>(message.binary));
    stream.next(message.id);
    stream.next(message.resolution);
    stream.next(message.data);
  }
  template <typename Stream>
  static void read(Stream& stream, holdfast_ros::Octomap& message) {
    std::uint8_t is_binary = 0;
    stream.next(message.header);
    stream.next(is_binary);
    stream.next(message.id);
    stream.next(message.resolution);
    stream.next(message.data);
    message.binary = is_binary != 0;
  }
  static std::uint32_t serializedLength(const holdfast_ros::Octomap& message) {
    return serializationLength(message.header) + 1 + serializationLength(message.id) + 8 +
           serializationLength(message.data);
  }
};

}  // namespace serialization
}  // namespace ros
