// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace holdfast {

/// Decodes PNG and JPEG files strictly: whatever the decoding library would quietly repair or convert (a truncated
/// file, a grey image where colour is due, 8-bit depth) is an InputError that names the file, what was found, what was
/// expected and what to do. Keeps its buffers from image to image; used by one thread.
class ImageDecoder {
 public:
  /// An 8-bit image with three channels, as 8UC3 blue green red in the orientation of the sensor (EXIF is not applied).
  cv::Mat read_colour(const std::filesystem::path& file);
  /// A 16-bit PNG with one channel, as 32FC1 [m]: value / depth_factor, 0 = no value.
  cv::Mat read_depth(const std::filesystem::path& file, double depth_factor);
  /// A PNG of labels, as stored: 8UC1 or 16UC1. Of a PNG with a palette (8 bits, such as those of Pascal VOC) the
  /// indices, not the colours.
  cv::Mat read_labels(const std::filesystem::path& file);

 private:
  void load(const std::filesystem::path& file);

  std::vector<std::uint8_t> bytes_;
  cv::Mat raw_depth_;
};

}  // namespace holdfast
