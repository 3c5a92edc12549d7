// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_views.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <optional>

#include "holdfast/core/error.hpp"
#include "holdfast/core/size_text.hpp"
#include "holdfast/image_files/image_decoder.hpp"
#include "source_interrupter.hpp"
#include "terminal.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;

bool is_image(const fs::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg";
}

/// Folders replaced by their images.
std::vector<fs::path> listed(const std::vector<fs::path>& files) {
  std::vector<fs::path> result;
  for (const fs::path& file : files) {
    if (!fs::exists(file)) throw InputError({file.string()}, "no such file or folder; expected images or a video");
    if (!fs::is_directory(file)) {
      result.push_back(file);
      continue;
    }
    std::vector<fs::path> images;
    for (const auto& entry : fs::directory_iterator(file))
      if (entry.is_regular_file() && is_image(entry.path())) images.push_back(entry.path());
    if (images.empty())
      throw InputError({file.string()}, "has no images; expected files *.png, *.jpg or *.jpeg that show the board");
    std::sort(images.begin(), images.end());
    result.insert(result.end(), images.begin(), images.end());
  }
  return result;
}

cv::Mat to_grey(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

}  // namespace

void CalibrationViews::add_files(const std::vector<fs::path>& files) {
  const std::vector<fs::path> all = listed(files);
  Progress progress(all.size(), options_.quiet);
  ImageDecoder decoder;
  std::uint64_t done = 0;
  for (const fs::path& file : all) {
    if (interrupted()) return;
    if (is_image(file))
      add_image(decoder.read_grey(file), file.string());
    else
      add_video(file);
    progress.update(++done, std::to_string(views_.size()) + " with the board");
  }
}

void CalibrationViews::add_video(const fs::path& file) {
  cv::VideoCapture video;
  if (!fs::is_regular_file(file) || !video.open(file.string()))
    throw InputError({file.string()}, "cannot be read; expected an image (PNG, JPEG) or a video that OpenCV reads");
  cv::Mat image;
  std::uint64_t number = 0;
  while (!interrupted() && video.read(image))
    if (!add_following(image, file.string() + ":" + std::to_string(number++))) return;
  if (number == 0) throw InputError({file.string()}, "has no pictures; expected a video of the board");
}

void CalibrationViews::add_source(FrameSource& source) {
  Progress progress(source.describe().frame_count, options_.quiet);
  const SourceInterrupter interrupter(source);
  std::uint64_t done = 0;
  while (!interrupted()) {
    const std::optional<SensorFrame> frame = source.next();
    if (!frame || !add_following(frame->colour, "frame " + std::to_string(done))) return;
    progress.update(++done, std::to_string(views_.size()) + " with the board");
  }
}

void CalibrationViews::require_size(const cv::Mat& image, const std::string& name) {
  if (size_.empty()) {
    size_ = image.size();
    first_ = name;
  }
  if (image.size() != size_)
    throw InputError({name}, "found an image of " + size_text(image.cols, image.rows) + " pixels; expected " +
                                 size_text(size_.width, size_.height) + " as of " + first_ +
                                 ": all images must come from one camera in one mode");
}

void CalibrationViews::add_image(const cv::Mat& grey, const std::string& name) {
  require_size(grey, name);
  ++looked_at_;
  BoardView view = detector_.find(grey);
  view.name = name;
  if (!view.corners.empty()) views_.push_back(std::move(view));
}

bool CalibrationViews::add_following(const cv::Mat& image, const std::string& name) {
  require_size(image, name);
  constexpr std::uint64_t usual_step = 5;
  const std::uint64_t step = options_.every == 0 ? usual_step : options_.every;
  if (sequence_++ % step != 0) return true;
  ++looked_at_;
  BoardView view = detector_.find(to_grey(image));
  view.name = name;
  if (!view.corners.empty() && is_new(view)) views_.push_back(std::move(view));
  return views_.size() < options_.most_views;
}

bool CalibrationViews::is_new(const BoardView& view) const {
  // Pictures of a board that rests say the same again and would outweigh the others.
  const double least = 0.03 * size_.width;
  return std::all_of(views_.begin(), views_.end(), [&](const BoardView& earlier) {
    double sum = 0.0;
    std::size_t common = 0;
    for (std::size_t i = 0, k = 0; i < view.corners.size() && k < earlier.corners.size();) {
      if (view.corners[i] == earlier.corners[k]) {
        sum += (view.pixels[i] - earlier.pixels[k]).norm();
        ++common;
      }
      view.corners[i] < earlier.corners[k] ? ++i : ++k;
    }
    return common == 0 || sum > least * static_cast<double>(common);
  });
}

}  // namespace holdfast
