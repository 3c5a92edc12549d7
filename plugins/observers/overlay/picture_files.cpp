// SPDX-License-Identifier: BSD-3-Clause
#include "picture_files.hpp"

#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "holdfast/core/atomic_file.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::overlay_plugin {

namespace fs = std::filesystem;

PictureFiles::PictureFiles(Settings settings) : settings_(std::move(settings)) {}

PictureFiles::~PictureFiles() {
  try {
    close();
  } catch (const Error&) {
    // The partial file stays under its partial name, which says what is wrong with it.
  }
}

fs::path PictureFiles::video_file(bool partial) const {
  return settings_.folder / (std::string(partial ? "overlay.partial." : "overlay.") + choice_name(settings_.format));
}

void PictureFiles::open_video(cv::Size size) {
  const fs::path file = video_file(true);
  const bool is_mp4 = settings_.format == PictureFormat::mp4;
  video_ = std::make_unique<cv::VideoWriter>();
  // Motion JPEG is written by OpenCV itself: no library can be missing, and the bytes are always the same.
  const bool opened =
      is_mp4 ? video_->open(file.string(), cv::VideoWriter::fourcc('m', 'p', '4', 'v'), settings_.frame_rate, size)
             : video_->open(file.string(), cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                            settings_.frame_rate, size);
  if (opened) return;
  video_.reset();
  throw InputError({file.string()}, std::string("this OpenCV cannot write ") +
                                        (is_mp4 ? "MPEG-4 video (its FFmpeg part is missing?)" : "Motion JPEG video") +
                                        "; choose another format of the observer 'overlay', such as jpg");
}

void PictureFiles::write(std::uint64_t index, const cv::Mat& picture) {
  std::error_code error;
  fs::create_directories(settings_.folder, error);
  if (error) throw InputError({settings_.folder.string()}, "the folder cannot be made: " + error.message());
  if (settings_.format == PictureFormat::avi || settings_.format == PictureFormat::mp4) {
    if (!video_) open_video(picture.size());
    has_pictures_ = true;
    video_->write(picture);
    return;
  }
  char name[48];
  std::snprintf(name, sizeof(name), "frame_%06llu.%s", static_cast<unsigned long long>(index),
                choice_name(settings_.format));
  std::vector<int> options;
  if (settings_.format == PictureFormat::jpg)
    options = {cv::IMWRITE_JPEG_QUALITY, settings_.quality};
  else
    options = {cv::IMWRITE_PNG_COMPRESSION, 1};  // the pictures are many, and waiting for them costs frames
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(std::string(".") + choice_name(settings_.format), picture, bytes, options))
    throw InputError({(settings_.folder / name).string()}, "this OpenCV cannot write the format");
  write_file_atomically(settings_.folder / name, std::string(bytes.begin(), bytes.end()), Durability::later);
  has_pictures_ = true;
}

void PictureFiles::close() {
  if (!has_pictures_) return;
  if (video_) close_video();
  has_pictures_ = false;
  sync_file_system(settings_.folder);
}

void PictureFiles::close_video() {
  video_->release();
  video_.reset();
  std::error_code error;
  fs::rename(video_file(true), video_file(false), error);
  if (error) throw InputError({video_file(false).string()}, "cannot be written: " + error.message());
}

}  // namespace holdfast::overlay_plugin
