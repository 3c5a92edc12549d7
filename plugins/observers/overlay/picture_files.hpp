// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

namespace cv {
class VideoWriter;
}

namespace holdfast::overlay {

/// Writes pictures into a folder, as single files or as one video. The folder and a video are made with the first
/// picture. Every file has its name only when it is complete; a video gets it from close() or the destructor.
class PictureFiles {
 public:
  struct Settings {
    std::filesystem::path folder;
    std::string format;        ///< png, jpg, avi (Motion JPEG) or mp4 (MPEG-4)
    int quality = 90;          ///< of jpg, 1..100
    double frame_rate = 30.0;  ///< of a video [1/s]
  };

  explicit PictureFiles(Settings settings);
  ~PictureFiles();

  /// All pictures must have one size. Throws InputError naming the file when it cannot be written, or when OpenCV was
  /// built without the video's format.
  void write(std::uint64_t index, const cv::Mat& picture);
  /// Completes the video, if there is one; nothing may be written afterwards.
  void close();

 private:
  void open_video(cv::Size size);
  std::filesystem::path video_file(bool partial) const;

  Settings settings_;
  std::unique_ptr<cv::VideoWriter> video_;
};

}  // namespace holdfast::overlay
