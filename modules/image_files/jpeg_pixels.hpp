// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>

namespace holdfast {

/// Decodes a JPEG (ITU-T T.81) of one or three channels and of this size, as examine_image() found it, to 8UC3, blue
/// green red, in the orientation of the sensor; the three channels of a grey image are equal. The pixels are those that
/// OpenCV gives, which uses the same library. Where the data are damaged, OpenCV prints a message and makes pixels up;
/// this prints nothing, and returns false. A build without libjpeg does as OpenCV does.
bool decode_jpeg(std::span<const std::uint8_t> file, const cv::Size& size, cv::Mat& colour);

}  // namespace holdfast
