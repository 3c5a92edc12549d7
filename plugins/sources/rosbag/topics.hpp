// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "bag.hpp"

namespace holdfast::rosbag_plugin {

/// The topics that a source reads; an empty name means none.
struct ChosenTopics {
  BagTopic colour, depth, camera_info;
};

/// What the configuration says of each topic: a name, "none" (not of colour), or nothing: it is looked for.
struct TopicNames {
  std::string colour, depth, camera_info;
};

/// Finds the topics. Without a name, an image topic is that of a usual name whose images are colour or depth, or the
/// only one; camera_info is the one beside the colour images, as ROS names it. Throws InputError that lists all topics
/// if a topic is missing, of another type or encoding, without messages, or if there are several to choose from.
ChosenTopics choose_topics(Bag& bag, const TopicNames& names);

/// Whether a topic of colour images has rectified ones, by the names of image_proc.
bool is_rectified(const std::string& colour_topic);

}  // namespace holdfast::rosbag_plugin
