// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "openni2_source.hpp"

namespace holdfast::openni2_plugin {

namespace {

constexpr double seconds = 1e-6;                  // of a unit of the camera's clock
constexpr std::uint64_t most_lost_at_once = 300;  // a longer gap is a camera that paused

}  // namespace

void Openni2Settings::describe(ParameterTable<Openni2Settings>& table) {
  using S = Openni2Settings;
  table.add("device", &S::device, "URI of the camera; empty = the first one");
  table
      .add("registration", &S::registration,
           "device: the camera registers its depth to its colour; none: they fit already")
      .one_of({"device", "none"});
  table
      .add("max_time_difference", &S::max_time_difference,
           "upper bound of the time difference between a colour image and its depth image")
      .range(1e-6, 1.0)
      .unit("s");
}

Openni2Source::Openni2Source(const Openni2Settings& settings, const CreationContext& context)
    : Openni2Source(settings, open_depth_camera({settings.device, context.camera.width, context.camera.height,
                                                 context.camera.frame_rate, settings.registration == "device"})) {}

Openni2Source::Openni2Source(const Openni2Settings& settings, std::unique_ptr<DepthCamera> camera)
    : settings_(settings), camera_(std::move(camera)) {}

std::string Openni2Source::place() const { return settings_.device.empty() ? "OpenNI 2" : settings_.device; }

SourceDescription Openni2Source::describe() const {
  SourceDescription description;
  description.name = "camera of OpenNI 2";
  description.has_depth = true;
  description.can_read_ahead = true;
  return description;
}

void Openni2Source::skip(std::uint64_t time, const char* reason) {
  if (has_given_) skipped_.push_back({index_++, static_cast<double>(time) * seconds, place() + ": " + reason});
}

void Openni2Source::take_colour(StreamImage image) {
  if (last_time_ && image.time <= *last_time_)
    throw InputError({place()}, "gave a colour image of " + std::to_string(image.time) + " us after one of " +
                                    std::to_string(*last_time_) +
                                    " us; expected time stamps that increase; unplug the camera and plug it in again");
  if (colour_) skip(colour_->time, "there is no depth image near enough in time");
  if (last_number_ && image.number > *last_number_ + 1 && image.number - *last_number_ - 1 <= most_lost_at_once) {
    const std::uint64_t lost = image.number - *last_number_ - 1;
    for (std::uint64_t i = 1; i <= lost; ++i)
      skip(*last_time_ + (image.time - *last_time_) * i / (lost + 1), "was not fetched in time");
  }
  last_number_ = image.number;
  last_time_ = image.time;
  colour_ = std::move(image);
}

void Openni2Source::take(StreamImage image) {
  if (image.is_depth)
    depth_ = std::move(image);
  else
    take_colour(std::move(image));
}

std::optional<SensorFrame> Openni2Source::pair() {
  if (!colour_ || !depth_) return std::nullopt;
  const double delay = (static_cast<double>(depth_->time) - static_cast<double>(colour_->time)) * seconds;
  if (delay <= -settings_.max_time_difference) return std::nullopt;  // the depth image that comes next may fit
  if (delay >= settings_.max_time_difference) {
    skip(colour_->time, "there is no depth image near enough in time");
    colour_.reset();
    return std::nullopt;
  }
  SensorFrame frame;
  frame.index = index_++;
  frame.timestamp = static_cast<double>(colour_->time) * seconds;
  frame.depth_delay = delay;
  frame.colour = colour_->image;
  frame.depth = depth_->image;
  colour_.reset();
  depth_.reset();
  has_given_ = true;
  return frame;
}

std::optional<SensorFrame> Openni2Source::next() {
  while (!has_ended_) {
    std::optional<StreamImage> image;
    try {
      image = camera_->next([this] { return is_interrupted(); });
    } catch (const InputError&) {
      has_ended_ = true;
      throw;
    }
    if (!image) {
      has_ended_ = true;
      if (!has_given_ && !is_interrupted())
        throw InputError({place()}, "gave no colour image with a depth image within " +
                                        std::to_string(settings_.max_time_difference) +
                                        " s; set `source.openni2.max_time_difference`");
      return std::nullopt;
    }
    take(std::move(*image));
    if (std::optional<SensorFrame> frame = pair()) return frame;
  }
  return std::nullopt;
}

}  // namespace holdfast::openni2_plugin

HOLDFAST_PLUGIN(openni2, registry) {
  using namespace holdfast::openni2_plugin;
  registry.add<holdfast::FrameSource, Openni2Source, Openni2Settings>(
      {.name = "openni2",
       .summary = "Cameras with colour and depth through OpenNI 2 (Kinect, Xtion, Astra).",
       .paper = ""});
}
