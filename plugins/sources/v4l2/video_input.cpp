// SPDX-License-Identifier: BSD-3-Clause
#include "video_input.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/core/size_text.hpp"

namespace holdfast::v4l2_plugin {

namespace {

/// OpenCV prints why it cannot open something; our errors say it.
class QuietOpenCv {
 public:
  QuietOpenCv() : level_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~QuietOpenCv() { cv::utils::logging::setLogLevel(level_); }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

 private:
  cv::utils::logging::LogLevel level_;
};

/// FFmpeg, below OpenCV, prints too, unless OpenCV tells it not to when it is used for the first time.
void silence_ffmpeg() {
  constexpr const char* quiet = "-8";
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", quiet, /*overwrite=*/0);
}

/// Signals go to other threads, or wait: OpenCV prints a message when one ends its poll().
class BlockedSignals {
 public:
  BlockedSignals() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before_);
  }
  ~BlockedSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_;
};

class OpenCvVideo : public VideoInput {
 public:
  explicit OpenCvVideo(cv::VideoCapture capture) : capture_(std::move(capture)) {}
  bool grab() override {
    const QuietOpenCv quiet;
    return capture_.grab();
  }
  cv::Mat decode() override {
    cv::Mat image;
    if (!capture_.retrieve(image)) return {};
    return image.clone();  // the buffer is used again
  }
  double time() const override { return capture_.get(cv::CAP_PROP_POS_MSEC) * 1e-3; }

 protected:
  cv::VideoCapture capture_;
};

class OpenCvCamera final : public OpenCvVideo {
 public:
  using OpenCvVideo::OpenCvVideo;
  bool wait(double seconds) override {
    constexpr double nanoseconds = 1e9;
    const QuietOpenCv quiet;
    const BlockedSignals blocked;
    std::vector<int> ready;
    try {
      return cv::VideoCapture::waitAny({capture_}, ready, static_cast<std::int64_t>(seconds * nanoseconds)) &&
             !ready.empty();
    } catch (const cv::Exception&) {
      return true;  // the driver reports an error, as for a camera that was unplugged; so will grab()
    }
  }
};

std::string without_zeros(double number) {
  char text[64];
  std::snprintf(text, sizeof(text), "%g", number);
  return text;
}

void set_exposure(cv::VideoCapture& capture, double exposure, const std::string& device) {
  // The numbers of V4L2_CID_EXPOSURE_AUTO; the unit of V4L2_CID_EXPOSURE_ABSOLUTE is 0.1 ms.
  constexpr double manual = 1.0, automatic = 3.0, units_per_millisecond = 10.0;
  if (exposure <= 0.0) {
    capture.set(cv::CAP_PROP_AUTO_EXPOSURE, automatic);  // a camera that cannot has one exposure
    return;
  }
  if (!capture.set(cv::CAP_PROP_AUTO_EXPOSURE, manual) ||
      !capture.set(cv::CAP_PROP_EXPOSURE, std::round(exposure * units_per_millisecond)))
    throw InputError({device}, "the camera refuses an exposure of " + without_zeros(exposure) +
                                   " ms; leave out `source.v4l2.exposure`, or see `v4l2-ctl --list-ctrls`");
}

}  // namespace

std::unique_ptr<VideoInput> open_camera(const CameraRequest& request) {
  const bool is_number =
      !request.device.empty() && std::all_of(request.device.begin(), request.device.end(),
                                             [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; });
  const std::string device = is_number ? "/dev/video" + request.device : request.device;
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(device, error);
  if (!std::filesystem::exists(status))
    throw InputError({device},
                     "there is no such camera; plug it in, or set `source.v4l2.device`; `v4l2-ctl "
                     "--list-devices` lists the cameras");
  if (!std::filesystem::is_character_file(status))
    throw InputError({device},
                     "is not a camera; expected a device such as /dev/video0; a video file is "
                     "`source.v4l2.file`");
  cv::VideoCapture capture;
  {
    const QuietOpenCv quiet;
    capture.open(device, cv::CAP_V4L2);
  }
  if (!capture.isOpened())
    throw InputError({device},
                     "the camera cannot be opened: another program may use it, or you may not (group "
                     "`video`); or it gives no pictures");
  // Compressed in the camera, as a raw picture is too much for USB 2 at 30 frames per second; refused by some.
  capture.set(cv::CAP_PROP_FOURCC, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'));
  capture.set(cv::CAP_PROP_FRAME_WIDTH, request.width);
  capture.set(cv::CAP_PROP_FRAME_HEIGHT, request.height);
  capture.set(cv::CAP_PROP_FPS, request.frame_rate);
  const int width = static_cast<int>(capture.get(cv::CAP_PROP_FRAME_WIDTH));
  const int height = static_cast<int>(capture.get(cv::CAP_PROP_FRAME_HEIGHT));
  if (width != request.width || height != request.height)
    throw InputError({device}, "the camera gives " + size_text(width, height) + " pixels where the configuration has " +
                                   size_text(request.width, request.height) +
                                   "; calibrate it at a size that it has (`v4l2-ctl --list-formats-ext`), and give "
                                   "that size under `camera:`");
  set_exposure(capture, request.exposure, device);
  const QuietOpenCv quiet;
  if (!capture.grab())  // starts the stream, without which OpenCV cannot wait for a frame
    throw InputError({device}, "the camera gives no pictures; unplug it and plug it in again");
  return std::make_unique<OpenCvCamera>(std::move(capture));
}

std::unique_ptr<VideoInput> open_video(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    throw InputError({file.string()}, "is missing; expected a video file; set `source.v4l2.file`");
  if (!std::filesystem::is_regular_file(file, error))
    throw InputError({file.string()}, "is not a file; expected a video file; a camera is `source.v4l2.device`");
  silence_ffmpeg();
  const QuietOpenCv quiet;
  for (const int reader : {cv::CAP_FFMPEG, cv::CAP_GSTREAMER, cv::CAP_OPENCV_MJPEG}) {
    cv::VideoCapture capture;
    try {
      capture.open(file.string(), reader);
    } catch (const cv::Exception&) {
      continue;
    }
    if (capture.isOpened()) return std::make_unique<OpenCvVideo>(std::move(capture));
  }
  throw InputError({file.string()},
                   "cannot be opened as a video; expected one of the formats that OpenCV was built "
                   "with, such as MP4 or AVI; convert it, or copy it again");
}

}  // namespace holdfast::v4l2_plugin
