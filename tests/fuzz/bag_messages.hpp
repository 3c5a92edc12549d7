// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "bag.hpp"
#include "fuzz.hpp"
#include "image_message.hpp"
#include "topics.hpp"

namespace holdfast::fuzz {

/// Reads a message as everything that it may be, and checks what the readers promise.
inline void read_message(const rosbag_plugin::Message& message) {
  using namespace rosbag_plugin;
  const auto is_small = [&](const cv::Size& size) {
    if (size.width > 640 || size.height > 480) throw InputError({message.place}, "is larger than the camera");
  };
  accepts([&] { require(std::isfinite(read_stamp(message)), "stamps"); });
  accepts([&] { encoding_of(message); });
  ImageMessages images;
  accepts([&] {
    const cv::Mat colour = images.colour(message, is_small);
    require(colour.type() == CV_8UC3 && !colour.empty(), "colour is blue, green, red");
  });
  accepts([&] {
    const cv::Mat depth = images.depth(message, 1000.0, is_small);
    require(depth.type() == CV_32FC1 && !depth.empty(), "depth is in metres");
    for (int y = 0; y < depth.rows; ++y)
      for (int x = 0; x < depth.cols; ++x) require(depth.at<float>(y, x) >= 0.0F, "depth is positive or missing");
  });
  accepts([&] {
    const Camera camera = read_camera_info(message, false);
    require(camera.fx > 0.0 && camera.fy > 0.0 && camera.width > 0 && camera.height > 0, "a camera has an area");
    require(camera.distortion.trouble().empty(), "the coefficients fit the lens");
  });
  accepts([&] {
    const double baseline = read_right_camera_info(message).baseline;
    require(baseline > 0.0 && std::isfinite(baseline), "the right camera is on the right");
  });
}

/// Reads all messages of a recording, and chooses topics as the source does.
inline void read_bag(rosbag_plugin::Bag& bag) {
  using namespace rosbag_plugin;
  for (const BagTopic& topic : bag.topics()) {
    if (!topic.is_readable()) continue;
    for (const BagMessage& message : bag.messages(topic.name))
      accepts([&] {
        const std::size_t head = bag.head(message, stamp_bytes).bytes.size();
        require(head <= stamp_bytes, "no more is given than was wanted");
        const Message content = bag.content(message);
        require(content.bytes.size() >= head, "the head is a part of the content");
        read_message(content);
      });
  }
  choose_topics(bag, {});
}

}  // namespace holdfast::fuzz
