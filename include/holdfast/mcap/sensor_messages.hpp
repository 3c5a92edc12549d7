// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/imu_sample.hpp"
#include "holdfast/mcap/message_sink.hpp"

/// Messages of ROS 2 as its recordings hold them: sensor_msgs/msg in the Common Data Representation (XCDR1 of
/// DDS-XTypes 1.3, 7.4.1), plain and little-endian.
namespace holdfast::mcap {

/// The header of a message. `stamp`: nanoseconds since 1970, 0 to 2^31 seconds; see message_stamp().
struct MessageHeader {
  std::uint64_t stamp = 0;
  std::string frame;  ///< of coordinates, such as "camera_color_optical_frame"
};

/// The stamp of a time in seconds, rounded to nanoseconds. Throws Error for a time that a message cannot hold: one that
/// is negative, not finite, or not before 2^31 seconds.
std::uint64_t message_stamp(double seconds);

/// A channel with messages of a type, such as "Image", with its definition. Known are Image, CompressedImage,
/// CameraInfo and Imu.
Channel sensor_channel(const std::string& topic, const std::string& type);

/// Image. `encoding` names the type of the pixels, such as "bgr8" or "32FC1", which is not checked.
std::string image_message(const MessageHeader& header, const std::string& encoding, const cv::Mat& pixels);
/// CompressedImage. `format`: such as "png".
std::string compressed_image_message(const MessageHeader& header, const std::string& format, const std::string& bytes);
/// CameraInfo of raw images: plumb_bob, rational_polynomial or equidistant, as the lens has it. P is K, for one camera.
std::string camera_info_message(const MessageHeader& header, const Camera& camera);
/// CameraInfo of the right camera of a rectified pair: that of the left one, with the baseline in P.
std::string right_camera_info_message(const MessageHeader& header, const Camera& camera);
/// Imu without an orientation; covariances are unknown. The stamp is that of `header`.
std::string imu_message(const MessageHeader& header, const ImuSample& sample);

}  // namespace holdfast::mcap
