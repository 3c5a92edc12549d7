// SPDX-License-Identifier: BSD-3-Clause
#include "video_frames.hpp"

#include <cstdlib>
#include <opencv2/core/utils/logger.hpp>
#include <utility>

#include "holdfast/core/counted.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::phone_plugin {

VideoFrames::VideoFrames(std::filesystem::path file) : file_(std::move(file)) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file_, error))
    throw InputError({file_.string()}, "is missing; expected the video of the recording; copy it again");
  open();
  size_ = {static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_WIDTH)),
           static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_HEIGHT))};
}

void VideoFrames::open() {
  constexpr const char* quiet = "-8";
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", quiet, /*overwrite=*/0);  // our errors say it
  const auto level = cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  const bool is_open = capture_.open(file_.string());
  cv::utils::logging::setLogLevel(level);
  if (!is_open)
    throw InputError({file_.string()},
                     "cannot be opened as a video; expected one that OpenCV can decode, of an iPhone HEVC; copy it "
                     "again");
  capture_.set(cv::CAP_PROP_ORIENTATION_AUTO, 0.0);
  position_ = 0;
}

cv::Mat VideoFrames::read(std::size_t index) {
  if (index < position_) open();
  cv::Mat frame;
  while (position_ <= index) {
    if (!capture_.grab() || (position_ == index && !capture_.retrieve(frame)))
      throw InputError({file_.string()}, "ends after " + counted(position_, "frame") + "; expected frame " +
                                             std::to_string(index) + ": the recording was cut, or copied in part");
    ++position_;
  }
  return frame.clone();  // the buffer is used again
}

}  // namespace holdfast::phone_plugin
