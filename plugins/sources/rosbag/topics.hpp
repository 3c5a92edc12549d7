// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "bag.hpp"

namespace holdfast::rosbag_plugin {

/// The topics that a source reads; an empty name means none.
struct ChosenTopics {
  BagTopic colour, depth, camera_info;
  BagTopic right, right_camera_info;  ///< of the right camera of a pair, whose left one is `colour`
};

/// What the configuration says of each topic: a name, "none" (not of colour), or nothing: it is looked for.
struct TopicNames {
  std::string colour, depth, camera_info;
  std::string right;  ///< is not looked for; with it there is no depth
};

/// Finds the topics. Without a name, an image topic is that of a usual name whose images are colour or depth, or the
/// only one; camera_info is the one beside the images, as ROS names it. Throws InputError that lists all topics if a
/// topic is missing, of another type or encoding, without messages, or if there are several to choose from.
ChosenTopics choose_topics(Bag& bag, const TopicNames& names);

/// Whether a topic of colour images has rectified ones, by the names of image_proc.
bool is_rectified(const std::string& colour_topic);

}  // namespace holdfast::rosbag_plugin
