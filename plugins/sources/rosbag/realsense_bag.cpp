// SPDX-License-Identifier: BSD-3-Clause
#include "realsense_bag.hpp"

#include <cmath>
#include <memory>
#include <string_view>

#include "holdfast/core/error.hpp"
#include "image_message.hpp"

namespace holdfast::rosbag_plugin {

namespace {

constexpr std::string_view image_end = "/image/data";

/// "/device_0/sensor_0/Depth_0" of a topic of images.
std::string stream_of(const std::string& topic) { return topic.substr(0, topic.size() - image_end.size()); }

[[noreturn]] void refuse_recording(const Bag& bag, const std::string& problem) {
  throw InputError({bag.path().string()},
                   problem +
                       "; expected a recording of librealsense with the calibration of depth and colour; record "
                       "`align_depth` with realsense2_camera, or use the colour images alone: "
                       "`source.rosbag.depth: none`");
}

/// The only message of the only topic that begins so; nothing without one.
std::optional<BagTopic> topic_below(Bag& bag, const std::string& beginning) {
  for (const BagTopic& topic : bag.topics())
    if (topic.name.starts_with(beginning) && topic.messages > 0) return topic;
  return std::nullopt;
}

/// A geometry_msgs/Transform; librealsense stores the motion of points of the reference into the stream.
Eigen::Isometry3d read_transform(const Message& message) {
  const std::unique_ptr<MessageReader> reader = message.open();
  double n[7];
  for (double& number : n) {
    number = reader->number<double>("transform");
    if (!std::isfinite(number)) throw InputError({message.place}, "has a transform with a number that is none");
  }
  const Eigen::Quaterniond rotation(n[6], n[3], n[4], n[5]);
  constexpr double tolerance = 1e-2;
  if (std::abs(rotation.norm() - 1.0) > tolerance)
    throw InputError({message.place}, "has a rotation whose quaternion is not of length 1; the message is damaged");
  Eigen::Isometry3d transform(rotation.normalized());
  transform.translation() = Eigen::Vector3d(n[0], n[1], n[2]);
  return transform;
}

/// T_stream_reference, and the number of the reference.
struct StreamPose {
  Eigen::Isometry3d T_stream_reference;
  std::string reference;
};

StreamPose read_stream_pose(Bag& bag, const std::string& stream) {
  const std::optional<BagTopic> topic = topic_below(bag, stream + "/tf/");
  if (!topic || topic->type != "geometry_msgs/Transform") refuse_recording(bag, "has no topic '" + stream + "/tf/0'");
  return {read_transform(bag.content(bag.messages(topic->name).front())), topic->name.substr(stream.size() + 4)};
}

}  // namespace

bool is_realsense_stream(const std::string& topic, const std::string& kind) {
  return topic.starts_with("/device_") && topic.ends_with(image_end) &&
         topic.find('/' + kind + '_') != std::string::npos;
}

std::string realsense_camera_info(const std::string& topic) { return stream_of(topic) + "/info/camera_info"; }

RealsenseDepth read_realsense_depth(Bag& bag, const std::string& colour_topic, const std::string& depth_topic) {
  const std::optional<BagTopic> info = topic_below(bag, realsense_camera_info(depth_topic));
  if (!info || info->type != camera_info_type)
    refuse_recording(bag, "has no topic '" + realsense_camera_info(depth_topic) + "'");
  const StreamPose colour = read_stream_pose(bag, stream_of(colour_topic)),
                   depth = read_stream_pose(bag, stream_of(depth_topic));
  if (colour.reference != depth.reference)
    refuse_recording(bag, "has poses of colour and depth relative to different streams");
  RealsenseDepth result;
  result.camera = read_camera_info(bag.content(bag.messages(info->name).front()), false);
  result.T_colour_depth = colour.T_stream_reference * depth.T_stream_reference.inverse();
  constexpr double largest_baseline = 0.5;  // [m]
  if (result.T_colour_depth.translation().norm() > largest_baseline)
    refuse_recording(bag, "has a depth camera " + std::to_string(result.T_colour_depth.translation().norm()) +
                              " m from the colour camera, which lie in one housing");
  const std::string stream = stream_of(depth_topic);
  const std::string sensor = stream.substr(0, stream.rfind('/'));
  for (const char* name : {"/option/Depth Units/value", "/option/Depth_Units/value"})
    if (const std::optional<BagTopic> units = topic_below(bag, sensor + name);
        units && units->type == "std_msgs/Float32") {
      const Message message = bag.content(bag.messages(units->name).front());
      const auto metres = message.open()->number<float>("depth units");
      if (!(metres > 0.0F && metres <= 1.0F))
        throw InputError({message.place},
                         "has depth units of " + std::to_string(metres) + " m; expected 0.001 or less");
      result.factor = std::round(1e2 / static_cast<double>(metres)) / 1e2;
    }
  return result;
}

}  // namespace holdfast::rosbag_plugin
