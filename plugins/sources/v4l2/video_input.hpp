// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

namespace holdfast::v4l2_plugin {

/// A camera or a video file, as the source sees it; tests give one of their own. Used by one thread.
class VideoInput {
 public:
  virtual ~VideoInput() = default;
  /// Waits for a frame at most so long [s]. True if grab() need not wait, at the end of a file too.
  virtual bool wait([[maybe_unused]] double seconds) { return true; }
  /// Waits for the next frame; false if there is none: the end of a file, or a camera that was unplugged.
  virtual bool grab() = 0;
  /// Decodes the frame that was grabbed: 8UC1 or 8UC3, blue green red. Empty if it cannot be decoded.
  virtual cv::Mat decode() = 0;
  /// Time of the frame that was grabbed, of the driver's clock or from the begin of the file [s]. Not positive for a
  /// driver without time stamps.
  virtual double time() const = 0;
};

/// What a camera is asked for.
struct CameraRequest {
  std::string device;  ///< a number, or a file such as /dev/video0
  int width = 0, height = 0;
  double frame_rate = 0.0;  ///< [1/s]
  double exposure = 0.0;    ///< [ms]; 0: the camera chooses it
};

/// Opens a camera of Video4Linux through OpenCV. Throws InputError for a device that is missing or cannot be opened,
/// and for what it cannot do, with what it offers instead.
std::unique_ptr<VideoInput> open_camera(const CameraRequest& request);
/// Opens a video file of any format that OpenCV was built with. Throws InputError.
std::unique_ptr<VideoInput> open_video(const std::filesystem::path& file);

}  // namespace holdfast::v4l2_plugin
