// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include "holdfast/interfaces/observer.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/overlay.hpp"
#include "painter.hpp"
#include "picture_files.hpp"

namespace holdfast {

void OverlaySettings::describe(ParameterTable<OverlaySettings>& table) {
  using S = OverlaySettings;
  table.add("every", &S::every, "a picture is written for every frame whose index is a multiple of this number")
      .range(1, 100000);
  table.add("format", &S::format, "single files (png, jpg) or one video (avi, mp4)");
  table.add("layout", &S::layout, "the overlay alone, or the input image to its left");
  table.add("quality", &S::quality, "JPEG quality").range(1, 100);
}

namespace {

/// Pictures of what the pipeline believes about each frame. Needs an output folder, and does nothing without one.
class Overlay final : public Observer {
 public:
  Overlay(const OverlaySettings& settings, const CreationContext& context)
      : every_(static_cast<std::uint64_t>(settings.every)),
        is_on_(!context.output_directory.empty()),
        painter_(context.camera, settings.layout == PictureLayout::side_by_side),
        files_({.folder = context.output_directory / "overlay",
                .format = settings.format,
                .quality = settings.quality,
                .frame_rate = std::max(1.0, context.camera.frame_rate / settings.every)}) {}

  void on_frame(const SensorFrame& sensor_frame, const Frame& frame, const FrameResult& result) override {
    if (is_on_ && sensor_frame.index % every_ == 0)
      files_.write(sensor_frame.index, painter_.paint(sensor_frame, frame, result));
  }
  void on_finish(const Map&) override { files_.close(); }

 private:
  std::uint64_t every_;
  bool is_on_;
  overlay_plugin::Painter painter_;
  overlay_plugin::PictureFiles files_;
};

}  // namespace

HOLDFAST_PLUGIN(overlay, registry) {
  registry.add<Observer, Overlay, OverlaySettings>(
      {.name = OverlaySettings::module,
       .summary = "Writes pictures of the frames with masks, moving regions and the static probability of features."});
}

}  // namespace holdfast
