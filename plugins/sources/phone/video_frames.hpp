// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <opencv2/videoio.hpp>

namespace holdfast::phone_plugin {

/// The frames of a video file by their numbers, as the sensor sees them: a rotation that the file asks for is not
/// applied. Reading in increasing order is quick. Used by one thread.
class VideoFrames {
 public:
  /// Opens the file with OpenCV. Throws InputError for a file that is missing or cannot be opened.
  explicit VideoFrames(std::filesystem::path file);

  /// Size of all frames [px].
  cv::Size size() const { return size_; }
  /// The number of frames that the file says it has; 0 if it does not.
  std::size_t count() const;
  /// Frame `index`, from 0, as 8UC3, blue green red. Throws InputError for one that the file does not have or that
  /// cannot be decoded, and for all that follow one, because OpenCV passes over an unknown number of frames there.
  cv::Mat read(std::size_t index);

 private:
  void open();
  [[noreturn]] void refuse(std::size_t index) const;

  std::filesystem::path file_;
  cv::VideoCapture capture_;
  cv::Size size_;
  std::size_t position_ = 0;                                        ///< of the next frame
  std::size_t readable_ = std::numeric_limits<std::size_t>::max();  ///< frames before the first that failed
};

}  // namespace holdfast::phone_plugin
