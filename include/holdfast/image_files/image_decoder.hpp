// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <vector>

namespace holdfast {

class PngRows;

/// Meaning of the stored values of a 16-bit depth image.
struct DepthEncoding {
  DepthEncoding(double factor_given = 5000.0, int no_value_given = largest)  // NOLINT(google-explicit-constructor)
      : factor(factor_given), no_value(no_value_given) {}

  static constexpr int largest = 65535;  ///< end of the range, which never denotes a distance
  double factor;                         ///< stored value of one metre
  int no_value;                          ///< stored value without a measurement, besides 0
};

/// Decodes PNG and JPEG files strictly: an image that the decoding library would repair or convert silently (a
/// truncated file, a grey image instead of colour, 8-bit depth) is an InputError that states the file, what was found,
/// what was expected and how to correct it. Common PNG files are decoded by libdeflate in a build with it, with the
/// same result as by OpenCV in less than half the time. Keeps its buffers between images; used by one thread.
class ImageDecoder {
 public:
  ImageDecoder();
  ~ImageDecoder();
  ImageDecoder(ImageDecoder&&) noexcept;
  ImageDecoder& operator=(ImageDecoder&&) noexcept;

  /// Whether read_grey() and read_widened() take grey PNG images of 16 bits, of which the upper 8 are used. Depth
  /// images have this form too: false by default, so that they are not taken for grey ones.
  void accept_16_bits(bool accept) { accepts_16_bits_ = accept; }

  /// Gets the size of an image before it is decoded, and throws if it is not the expected one: a small file can hold an
  /// image that takes gigabytes.
  using SizeCheck = std::function<void(const cv::Size&)>;

  /// Decodes an 8-bit image with three channels to 8UC3, blue green red, in the orientation of the sensor (EXIF is not
  /// applied).
  cv::Mat read_colour(const std::filesystem::path& file, const SizeCheck& check_size = {});
  /// Decodes an 8-bit image with one or three channels to 8UC1, in the orientation of the sensor. Colour is converted
  /// to grey as by OpenCV.
  cv::Mat read_grey(const std::filesystem::path& file, const SizeCheck& check_size = {});
  /// The same for an image with one or three channels to 8UC3; the three channels of a grey image are equal.
  cv::Mat read_widened(const std::filesystem::path& file, const SizeCheck& check_size = {});
  /// Decodes a 16-bit PNG with one channel to 32FC1 [m]: value / factor, 0 = no value.
  cv::Mat read_depth(const std::filesystem::path& file, const DepthEncoding& encoding,
                     const SizeCheck& check_size = {});
  /// As read_widened() and read_depth(), for the content of a file in memory; `name` denotes it in errors.
  cv::Mat decode_widened(std::span<const std::uint8_t> bytes, const std::string& name,
                         const SizeCheck& check_size = {});
  cv::Mat decode_depth(std::span<const std::uint8_t> bytes, const std::string& name, const DepthEncoding& encoding,
                       const SizeCheck& check_size = {});
  /// Decodes a PNG of labels to the stored type, 8UC1 or 16UC1. For a PNG with a palette (8 bits, such as those of
  /// Pascal VOC) the result contains the indices and not the colours.
  cv::Mat read_labels(const std::filesystem::path& file, const SizeCheck& check_size = {});

 private:
  // Of bytes_.
  cv::Mat decode_grey_or_colour(const std::filesystem::path& file, const SizeCheck& check_size);
  cv::Mat decode_widened(const std::filesystem::path& file, const SizeCheck& check_size);
  cv::Mat decode_depth(const std::filesystem::path& file, const DepthEncoding& encoding, const SizeCheck& check_size);
  void load(const std::filesystem::path& file);

  bool accepts_16_bits_ = false;
  std::vector<std::uint8_t> bytes_;
  cv::Mat raw_depth_;
  std::unique_ptr<PngRows> png_;
};

}  // namespace holdfast
