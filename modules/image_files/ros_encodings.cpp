// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/ros_encodings.hpp"

#include <opencv2/imgproc.hpp>

namespace holdfast {

namespace {

constexpr RosColourEncoding ros_encodings[] = {
    {"rgb8", CV_8UC3, cv::COLOR_RGB2BGR},
    {"bgr8", CV_8UC3, -1},
    {"8UC3", CV_8UC3, -1},
    {"rgba8", CV_8UC4, cv::COLOR_RGBA2BGR},
    {"bgra8", CV_8UC4, cv::COLOR_BGRA2BGR},
    {"mono8", CV_8UC1, cv::COLOR_GRAY2BGR},
    {"8UC1", CV_8UC1, cv::COLOR_GRAY2BGR},
};

}  // namespace

const RosColourEncoding* find_ros_colour_encoding(const std::string& name) {
  for (const RosColourEncoding& encoding : ros_encodings)
    if (name == encoding.name) return &encoding;
  return nullptr;
}

std::string ros_colour_encodings() {
  std::string names;
  for (const RosColourEncoding& encoding : ros_encodings)
    names += (names.empty() ? "" : ", ") + std::string(encoding.name);
  return names;
}

cv::Mat to_blue_green_red(const cv::Mat& view, const RosColourEncoding& encoding) {
  if (encoding.conversion < 0) return view.clone();
  cv::Mat converted;
  cv::cvtColor(view, converted, encoding.conversion);
  return converted;
}

}  // namespace holdfast
