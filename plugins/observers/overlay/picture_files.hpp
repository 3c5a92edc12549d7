// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "holdfast/settings/overlay.hpp"

namespace cv {
class VideoWriter;
}

namespace holdfast::overlay_plugin {

/// Writes pictures into a folder, as single files or as one video. The folder and the video are created with the first
/// picture. Files are renamed when they are complete; a video by close() or the destructor.
class PictureFiles {
 public:
  struct Settings {
    std::filesystem::path folder;
    PictureFormat format = PictureFormat::jpg;  ///< avi is Motion JPEG, mp4 is MPEG-4
    int quality = 90;                           ///< of jpg, 1..100
    double frame_rate = 30.0;                   ///< of a video [1/s]
  };

  explicit PictureFiles(Settings settings);
  ~PictureFiles();

  /// All pictures must have the same size. Throws InputError with the file if it cannot be written, or if OpenCV was
  /// built without the format of the video.
  void write(std::uint64_t index, const cv::Mat& picture);
  /// Completes the video, if there is one, and brings all pictures to the disk; no picture may be written afterwards.
  void close();

 private:
  void open_video(cv::Size size);
  void close_video();
  std::filesystem::path video_file(bool partial) const;

  Settings settings_;
  bool has_pictures_ = false;  // that may not have reached the disk
  std::unique_ptr<cv::VideoWriter> video_;
};

}  // namespace holdfast::overlay_plugin
