// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

#include "holdfast/core/camera.hpp"
#include "holdfast/image_files/image_decoder.hpp"
#include "message.hpp"

namespace holdfast::rosbag_plugin {

/// Types of messages that are read (wiki.ros.org/sensor_msgs). Their fields are the same in ROS 1 and ROS 2.
inline constexpr const char* image_type = "sensor_msgs/Image";
inline constexpr const char* compressed_image_type = "sensor_msgs/CompressedImage";
inline constexpr const char* camera_info_type = "sensor_msgs/CameraInfo";

/// The time stamp of a message, from its header [s].
double read_stamp(const Message& message);

/// What an image message says it holds: the encoding of an Image, such as "rgb8", or the format of a CompressedImage,
/// such as "rgb8; jpeg compressed bgr8".
std::string encoding_of(const Message& message);
/// Whether an encoding is one of depth: 16UC1, mono16 or 32FC1, or a format that names compressedDepth or 16UC1.
bool is_depth_encoding(const std::string& encoding);

/// Decodes messages of images. All functions throw InputError at its place for a message that is cut short, of another
/// size than it says, or of an encoding that is not among those that are named here. Used by one thread.
class ImageMessages {
 public:
  /// 8UC3, blue green red. Image: rgb8, bgr8, 8UC3 (as bgr8), rgba8, bgra8, mono8, 8UC1. CompressedImage: JPEG or PNG.
  cv::Mat colour(const Message& message, const ImageDecoder::SizeCheck& check_size);
  /// 32FC1 [m]. Image: 32FC1 in metres (what is not finite or not positive becomes 0), 16UC1 and mono16 as `encoding`
  /// says. CompressedImage: PNG of 16 bits, with or without the header of compressed_depth.
  cv::Mat depth(const Message& message, const DepthEncoding& encoding, const ImageDecoder::SizeCheck& check_size);

 private:
  ImageDecoder decoder_;
};

/// The camera of a CameraInfo: plumb_bob, rational_polynomial or equidistant (fisheye). `is_rectified`: of the
/// rectified image, by the projection matrix P and without distortion. Throws InputError for another model and for
/// numbers that cannot be.
Camera read_camera_info(const Message& message, bool is_rectified);
/// The baseline that the CameraInfo of the right camera of a rectified pair has [m]; nothing if it has none.
std::optional<double> read_baseline(const Message& message);
/// The camera of the rectified pair whose right one this CameraInfo is of: that of its projection matrix, which has the
/// baseline. Throws InputError as read_camera_info() does, and for one without a baseline.
Camera read_right_camera_info(const Message& message);

}  // namespace holdfast::rosbag_plugin
