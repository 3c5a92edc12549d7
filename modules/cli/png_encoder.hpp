// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace holdfast {

/// The bytes of a PNG file (ISO/IEC 15948) with an image of 8UC3, blue green red, or of 16UC1, without loss. In a build
/// with libdeflate in a third of the time of OpenCV's, at the same size: the difference to the row above, and the
/// fastest compression. Any thread may call it.
std::string encode_png(const cv::Mat& image);

}  // namespace holdfast
