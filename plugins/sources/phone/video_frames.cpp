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

std::size_t VideoFrames::count() const {
  const double count = capture_.get(cv::CAP_PROP_FRAME_COUNT);
  return count > 0.0 ? static_cast<std::size_t>(count) : 0;
}

cv::Mat VideoFrames::read(std::size_t index) {
  if (index >= readable_) refuse(index);
  if (index < position_) open();
  cv::Mat frame;
  for (; position_ <= index; ++position_)
    if (!capture_.grab() || (position_ == index && !capture_.retrieve(frame))) {
      readable_ = position_;
      refuse(index);
    }
  return frame.clone();  // the buffer is used again
}

void VideoFrames::refuse(std::size_t index) const {
  const std::string expected = "; expected frame " + std::to_string(index);
  if (readable_ >= count())
    throw InputError({file_.string()}, "ends after " + counted(readable_, "frame") + expected +
                                           ": the recording was cut, or copied in part");
  throw InputError({file_.string()}, "cannot be decoded at frame " + std::to_string(readable_) + expected +
                                         ": after damage it is not sure which frame is which; copy it again");
}

}  // namespace holdfast::phone_plugin
