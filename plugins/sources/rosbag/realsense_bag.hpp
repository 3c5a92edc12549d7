// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "bag.hpp"
#include "holdfast/core/camera.hpp"

/// Bags of librealsense's recorder (RealSense Viewer, rs-record), whose topics are described in its
/// src/media/readme.md: /device_0/sensor_0/Depth_0/image/data and beside it info/camera_info and tf/0. Depth is not
/// registered to colour.
namespace holdfast::rosbag_plugin {

/// Whether a topic is that of the images of a stream of librealsense: "Color" or "Depth".
bool is_realsense_stream(const std::string& topic, const std::string& kind);
/// The topic of the calibration of such a stream.
std::string realsense_camera_info(const std::string& topic);

/// What a bag says of its depth images.
struct RealsenseDepth {
  Camera camera;                     ///< of the depth images
  Eigen::Isometry3d T_colour_depth;  ///< maps points of the depth camera to the colour camera [m]
  std::optional<double> factor;  ///< value of one metre, by the option "Depth Units"; nothing if it was not recorded
};

/// Reads it for the topics of colour and depth. Throws InputError for a bag without the calibration of depth, or with
/// poses of the two streams that are missing or relative to different streams.
RealsenseDepth read_realsense_depth(Bag& bag, const std::string& colour_topic, const std::string& depth_topic);

}  // namespace holdfast::rosbag_plugin
