// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace holdfast {

/// An encoding of colour in messages of ROS (sensor_msgs/image_encodings).
struct RosColourEncoding {
  const char* name;
  int type;        ///< of OpenCV, such as CV_8UC3
  int conversion;  ///< cv::ColorConversionCodes to blue, green, red; -1 = none
};

/// rgb8, bgr8, 8UC3 (as bgr8), rgba8, bgra8, mono8 or 8UC1; null for another one. Any thread.
const RosColourEncoding* find_ros_colour_encoding(const std::string& name);
/// All names, separated by commas.
std::string ros_colour_encodings();
/// The image as 8UC3, blue green red, in memory of its own. `view`: of the type of the encoding.
cv::Mat to_blue_green_red(const cv::Mat& view, const RosColourEncoding& encoding);

}  // namespace holdfast
