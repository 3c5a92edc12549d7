// SPDX-License-Identifier: BSD-3-Clause
#include "topics.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "holdfast/core/error.hpp"
#include "image_message.hpp"
#include "realsense_bag.hpp"

namespace holdfast::rosbag_plugin {

namespace {

// TUM, openni_launch, realsense2_camera (of ROS 1 and 2), iai_kinect2, Azure_Kinect_ROS_Driver, zed_wrapper, usb_cam.
// Depth only where it is registered to the colour image; that of librealsense's recorder is registered by the source.
constexpr const char* usual_colour[] = {"/camera/rgb/image_color",
                                        "/camera/rgb/image_raw",
                                        "/camera/rgb/image_rect_color",
                                        "/camera/color/image_raw",
                                        "/camera/color/image_rect_color",
                                        "/camera/camera/color/image_raw",
                                        "/camera/camera/color/image_rect_color",
                                        "/kinect2/qhd/image_color_rect",
                                        "/rgb/image_raw",
                                        "/zed/zed_node/rgb/image_rect_color",
                                        "/usb_cam/image_raw",
                                        "/camera/image_raw"};
constexpr const char* usual_depth[] = {"/camera/depth/image",
                                       "/camera/depth_registered/image",
                                       "/camera/depth_registered/image_raw",
                                       "/camera/depth_registered/image_rect",
                                       "/camera/depth_registered/hw_registered/image_rect",
                                       "/camera/depth_registered/hw_registered/image_rect_raw",
                                       "/camera/aligned_depth_to_color/image_raw",
                                       "/camera/camera/aligned_depth_to_color/image_raw",
                                       "/kinect2/qhd/image_depth_rect",
                                       "/depth_to_rgb/image_raw",
                                       "/zed/zed_node/depth/depth_registered"};

bool is_image(const BagTopic& topic) { return topic.type == image_type || topic.type == compressed_image_type; }

/// Without what image_transport adds for compressed images.
std::string base_of(const std::string& topic) {
  for (const std::string_view transport : {"/compressedDepth", "/compressed"})
    if (topic.ends_with(transport)) return topic.substr(0, topic.size() - transport.size());
  return topic;
}

std::string listed(const Bag& bag) {
  std::string text;
  for (const BagTopic& topic : bag.topics())
    text += "\n  " + topic.name + (topic.type.empty() ? "" : "  " + topic.type) + "  " +
            std::to_string(topic.messages) + (topic.messages == 1 ? " message" : " messages") +
            (topic.is_readable() ? "" : ", serialised as '" + topic.encoding_name + "'");
  return text.empty() ? "; it has no topics" : "; its topics are" + text;
}

[[noreturn]] void refuse(const Bag& bag, const std::string& problem) {
  throw InputError({bag.path().string()}, problem + listed(bag));
}

BagTopic named_topic(const Bag& bag, const std::string& name, const char* parameter, bool is_of_images) {
  for (const BagTopic& topic : bag.topics()) {
    if (topic.name != name) continue;
    if (is_of_images ? !is_image(topic) : topic.type != camera_info_type)
      refuse(bag, "the topic '" + name + "' has messages of the type " + topic.type + "; expected " +
                      (is_of_images ? std::string(image_type) + " or " + compressed_image_type : camera_info_type) +
                      "; set `source.rosbag." + parameter + '`');
    if (!topic.is_readable())
      refuse(bag, "the topic '" + name + "' has messages that are serialised as '" + topic.encoding_name +
                      "'; expected cdr (ROS 2) or ros1; set `source.rosbag." + parameter + '`');
    if (topic.messages == 0) refuse(bag, "the topic '" + name + "' has no messages");
    return topic;
  }
  refuse(bag, "has no topic '" + name + "'; set `source.rosbag." + parameter + '`');
}

/// The topic of a usual name, or the only one. Of a topic that is there as it is and compressed, the first.
BagTopic found_topic(const Bag& bag, const std::vector<BagTopic>& candidates, std::span<const char* const> usual,
                     const char* parameter, const char* kind) {
  std::vector<BagTopic> different;  // sorted by name, so that what is not compressed comes first
  for (const BagTopic& topic : candidates)
    if (different.empty() || base_of(different.back().name) != base_of(topic.name)) different.push_back(topic);
  std::vector<BagTopic> of_usual_name;
  for (const BagTopic& topic : different)
    if (std::find(usual.begin(), usual.end(), base_of(topic.name)) != usual.end() ||
        is_realsense_stream(topic.name, kind[0] == 'c' ? "Color" : "Depth"))
      of_usual_name.push_back(topic);
  const std::vector<BagTopic>& choice = of_usual_name.empty() ? different : of_usual_name;
  if (choice.empty()) return {};
  if (choice.size() == 1) return choice.front();
  std::string names;
  for (const BagTopic& topic : choice) names += (names.empty() ? "'" : ", '") + topic.name + "'";
  refuse(bag, std::string("several topics have ") + kind + " images: " + names + "; name one with `source.rosbag." +
                  parameter + '`');
}

/// The topics to choose from: colour, and depth.
std::pair<std::vector<BagTopic>, std::vector<BagTopic>> image_topics(Bag& bag, const std::string& right) {
  std::vector<BagTopic> colour, depth;
  for (const BagTopic& topic : bag.topics()) {
    if (!is_image(topic) || !topic.is_readable() || topic.messages == 0) continue;
    if (!right.empty() && base_of(topic.name) == base_of(right)) continue;
    const std::string encoding = encoding_of(bag.content(bag.messages(topic.name).front()));
    (is_depth_encoding(encoding) ? depth : colour).push_back(topic);
  }
  return {colour, depth};
}

/// camera_info beside images; an empty name where there is none.
BagTopic info_beside(const Bag& bag, const std::string& images) {
  const std::string base = base_of(images);
  const std::string beside = is_realsense_stream(base, "Color") ? realsense_camera_info(base)
                                                                : base.substr(0, base.rfind('/') + 1) + "camera_info";
  for (const BagTopic& topic : bag.topics())
    if (topic.name == beside && topic.type == camera_info_type && topic.is_readable() && topic.messages > 0)
      return topic;
  return {};
}

}  // namespace

bool is_rectified(const std::string& colour_topic) {
  const std::string base = base_of(colour_topic);
  return base.substr(base.rfind('/') + 1).find("rect") != std::string::npos;
}

ChosenTopics choose_topics(Bag& bag, const TopicNames& names) {
  const bool has_right = !names.right.empty(), looks_for_depth = names.depth.empty() && !has_right;
  ChosenTopics chosen;
  if (!names.colour.empty()) chosen.colour = named_topic(bag, names.colour, "colour", true);
  if (has_right) chosen.right = named_topic(bag, names.right, "right", true);
  if (!names.depth.empty() && names.depth != "none") {
    if (has_right)
      refuse(bag,
             "is to be read with depth and with a right camera; expected one of both: remove `source.rosbag.depth` or "
             "`source.rosbag.right`");
    chosen.depth = named_topic(bag, names.depth, "depth", true);
  }
  if (names.colour.empty() || looks_for_depth) {
    const auto [colour, depth] = image_topics(bag, names.right);
    if (names.colour.empty()) chosen.colour = found_topic(bag, colour, usual_colour, "colour", "colour");
    if (looks_for_depth) chosen.depth = found_topic(bag, depth, usual_depth, "depth", "depth");
  }
  if (chosen.colour.name.empty()) refuse(bag, "has no colour images");
  if (chosen.colour.name == chosen.right.name)
    refuse(bag,
           "is to be read with the same images on the left and on the right; name the left ones with "
           "`source.rosbag.colour`");

  if (names.camera_info == "none") return chosen;
  chosen.camera_info = names.camera_info.empty() ? info_beside(bag, chosen.colour.name)
                                                 : named_topic(bag, names.camera_info, "camera_info", false);
  if (has_right) chosen.right_camera_info = info_beside(bag, chosen.right.name);
  return chosen;
}

}  // namespace holdfast::rosbag_plugin
