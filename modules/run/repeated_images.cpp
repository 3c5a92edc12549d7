// SPDX-License-Identifier: BSD-3-Clause
#include "repeated_images.hpp"

#include <functional>
#include <string_view>

#include "holdfast/core/counted.hpp"
#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

std::uint64_t image_fingerprint(const cv::Mat& image) {
  const std::size_t row_bytes = static_cast<std::size_t>(image.cols) * image.elemSize();
  std::uint64_t fingerprint = 0, first = 0;
  bool are_alike = true;
  for (int y = 0; y < image.rows; ++y) {
    const std::string_view row(reinterpret_cast<const char*>(image.ptr(y)), row_bytes);
    const std::uint64_t hash = std::hash<std::string_view>()(row);
    if (y == 0) first = hash;
    are_alike = are_alike && hash == first;
    fingerprint = fingerprint * 0x9e3779b97f4a7c15ULL + hash;
  }
  return are_alike ? 0 : fingerprint;
}

void RepeatFinder::add(double timestamp, std::uint64_t fingerprint) {
  const bool is_repeated = fingerprint != 0 && fingerprint == fingerprint_;
  fingerprint_ = fingerprint;
  if (!is_repeated) {
    begin_ = timestamp;
    return;
  }
  ++found_.frames;
  if (timestamp - begin_ <= found_.longest) return;
  found_.longest = timestamp - begin_;
  found_.begin = begin_;
}

std::string repetition_warning(const RepeatedImages& repeated, std::size_t frames) {
  constexpr double longest_harmless = 0.2;  // [s]
  constexpr double share_harmless = 0.05;
  if (repeated.longest < longest_harmless &&
      static_cast<double>(repeated.frames) <= share_harmless * static_cast<double>(frames))
    return "";
  return counted(repeated.frames, "frame") + (repeated.frames == 1 ? " has" : " have") +
         " the same colour image as the frame before, byte by byte, for up to " + fixed_text(repeated.longest, 2) +
         " s (from " + fixed_text(repeated.begin, 6) +
         " on): did a driver or a copy repeat images? Their poses are those of an earlier time. Take the repeated "
         "images out of the recording, or mend the driver";
}

}  // namespace holdfast
