// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/core/size_text.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "v4l2_source.hpp"

namespace holdfast::v4l2_plugin {

namespace {

std::unique_ptr<VideoInput> open_input(const V4l2Settings& settings, const Camera& camera) {
  if (!settings.file.empty()) return open_video(settings.file);
  return open_camera({settings.device, camera.width, camera.height,
                      settings.frame_rate > 0.0 ? settings.frame_rate : camera.frame_rate, settings.exposure});
}

double monotonic_time() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void V4l2Settings::describe(ParameterTable<V4l2Settings>& table) {
  using S = V4l2Settings;
  table.add("device", &S::device, "camera: its number, or its device such as /dev/video0");
  table.add("file", &S::file, "a video file in the place of the camera");
  table
      .add(
          "frame_rate", &S::frame_rate,
          "camera: the rate that it is asked for, 0 = frame_rate of the camera in the configuration; file: frame i has "
          "the time stamp i / frame_rate, 0 = the time stamps of the file")
      .range(0.0, 100000.0)
      .unit("Hz");
  table.add("exposure", &S::exposure, "exposure time that the camera is asked for; 0 = automatic")
      .range(0.0, 1000.0)
      .unit("ms");
}

V4l2Source::V4l2Source(const V4l2Settings& settings, const CreationContext& context)
    : V4l2Source(settings, {context.camera.width, context.camera.height}, open_input(settings, context.camera),
                 settings.file.empty()) {}

V4l2Source::V4l2Source(const V4l2Settings& settings, cv::Size size, std::unique_ptr<VideoInput> input, bool is_live)
    : settings_(settings), size_(size), input_(std::move(input)), is_live_(is_live) {}

std::string V4l2Source::place() const { return is_live_ ? settings_.device : settings_.file.string(); }

SourceDescription V4l2Source::describe() const {
  SourceDescription description;
  description.name = is_live_ ? "camera " + settings_.device : settings_.file.stem().string();
  description.can_read_ahead = true;
  return description;
}

double V4l2Source::stamp_of_frame() {
  if (!is_live_ && settings_.frame_rate > 0.0) return static_cast<double>(index_) / settings_.frame_rate;
  if (!is_live_) return input_->time();
  const double stamp = input_->time();
  if (!last_stamp_) has_driver_clock_ = stamp > 0.0;
  return has_driver_clock_ ? stamp : monotonic_time();
}

void V4l2Source::count_lost_frames(double stamp) {
  const std::size_t lost = lost_.before(stamp);
  for (std::size_t i = 1; i <= lost; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(lost + 1);
    skipped_.push_back(
        {index_++, *last_stamp_ + share * (stamp - *last_stamp_), place() + ": was not fetched in time"});
  }
}

/// Waits in short steps, because a driver that gives no frames cannot be interrupted.
bool V4l2Source::grab() {
  constexpr double patience = 10.0, step = 0.05;  // [s]
  for (double waited = 0.0; waited < patience && !is_interrupted(); waited += step)
    if (input_->wait(step)) return input_->grab();
  return false;
}

std::optional<SensorFrame> V4l2Source::next() {
  if (has_ended_) return std::nullopt;
  if (!grab()) {
    has_ended_ = true;
    if (is_interrupted()) return std::nullopt;
    if (is_live_)
      throw InputError({place()}, "the camera gave no more frames after " + std::to_string(given_) +
                                      "; it was unplugged, or its driver stopped");
    if (given_ > 0) return std::nullopt;
    throw InputError({place()}, "has no frame that can be decoded; convert it, or copy it again");
  }
  SensorFrame frame;
  frame.colour = input_->decode();
  if (frame.colour.empty())
    throw InputError({place()}, "frame " + std::to_string(index_) + " is damaged: it cannot be decoded");
  if (frame.colour.channels() == 1) cv::cvtColor(frame.colour, frame.colour, cv::COLOR_GRAY2BGR);
  if (frame.colour.size() != size_ || frame.colour.type() != CV_8UC3)
    throw InputError({place()}, "has frames of " + size_text(frame.colour.cols, frame.colour.rows) +
                                    " pixels, but the camera is " + size_text(size_.width, size_.height) +
                                    "; give the camera that took them under `camera:`");
  frame.timestamp = stamp_of_frame();
  if (last_stamp_ && !(frame.timestamp > *last_stamp_))
    throw InputError({place()}, "frame " + std::to_string(index_) + " has the time stamp " +
                                    std::to_string(frame.timestamp) + " s, not later than " +
                                    std::to_string(*last_stamp_) + " s before" +
                                    (is_live_ ? "; the clock of its driver is not usable"
                                              : "; set `source.v4l2.frame_rate`, so that frames are numbered"));
  if (is_live_) count_lost_frames(frame.timestamp);
  last_stamp_ = frame.timestamp;
  frame.index = index_++;
  ++given_;
  return frame;
}

}  // namespace holdfast::v4l2_plugin

HOLDFAST_PLUGIN(v4l2, registry) {
  using namespace holdfast::v4l2_plugin;
  registry.add<holdfast::FrameSource, V4l2Source, V4l2Settings>(
      {.name = "v4l2",
       .summary = "One colour camera (Video4Linux), or a video file, through OpenCV. Depth and scale are unknown.",
       .paper = ""});
}
