// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <utility>

#include "exr_depth.hpp"
#include "holdfast/core/counted.hpp"
#include "holdfast/image_files/phone_recording.hpp"
#include "holdfast/image_files/recorded_frames.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "video_frames.hpp"

namespace holdfast {

namespace {

struct PhoneSettings : RecordedFrames {
  std::filesystem::path path;
  int width = 0;
  double frame_rate = 30.0;
  double depth_factor = 0.0;
  int minimum_confidence = 1;

  static void describe(ParameterTable<PhoneSettings>& table) {
    table
        .add("path", &PhoneSettings::path,
             "folder that an app of a phone exported: Record3D (EXR + RGB sequence), NeRFCapture and others that write "
             "transforms.json, or Stray Scanner")
        .required();
    table
        .add("width", &PhoneSettings::width,
             "width of the frames, to which images and camera are scaled down; 0 = as recorded")
        .range(0, 8192)
        .unit("px");
    table.add("frame_rate", &PhoneSettings::frame_rate, "frame rate of a recording without time stamps")
        .range(0.001, 100000.0)
        .unit("Hz");
    table
        .add("depth_factor", &PhoneSettings::depth_factor,
             "value of one metre in depth images of whole numbers; 0 = as the recording says")
        .range(0.0, 65535.0);
    table
        .add("minimum_confidence", &PhoneSettings::minimum_confidence,
             "least confidence of depth that is used, where the recording has it: 0 = low, 1 = medium, 2 = high")
        .range(0, 2);
    add_rows(table, "frame");
  }
};

struct OpenedRecording {
  CalibratedRecording recording;
  Warnings warnings;
};

/// The recording, with readers for what is no PNG or JPEG file.
OpenedRecording open_recording(const PhoneSettings& settings) {
  OpenedRecording opened;
  CalibratedRecording& recording = opened.recording;
  recording = read_phone_recording({settings.path,
                                    settings.width,
                                    settings.frame_rate,
                                    settings.depth_factor,
                                    settings.minimum_confidence,
                                    {settings.start, settings.frames}});
  if (recording.colour_is_video) {
    const auto video = std::make_shared<phone_plugin::VideoFrames>(recording.files.front().colour);
    resize_frames(recording, video->size(), settings.width, settings.path.string());
    recording.readers.colour = [video](const ImageFiles& files) { return video->read(files.video_index); };
    if (const std::size_t lines = recording.truth.size(); video->count() > lines)
      opened.warnings.push_back({recording.files.front().colour_listed_at,
                                 "the list has " + counted(lines, "line") + ", but the video has " +
                                     counted(video->count(), "frame") +
                                     "; the last ones are not read, and if frames are missing elsewhere, colour, depth "
                                     "and poses do not belong together"});
  }
  if (recording.depth && recording.files.front().depth.extension() == ".exr")
    recording.readers.depth = [](const ImageFiles& files) { return phone_plugin::read_exr_depth(files.depth); };
  return opened;
}

/// A recording of a phone with a depth sensor, with the poses that it estimated as truth.
class PhoneSource final : public CalibratedSource {
 public:
  PhoneSource(const PhoneSettings& settings, const CreationContext&)
      : PhoneSource(open_recording(settings), settings) {}

  Warnings warnings() const override {
    Warnings warnings = warnings_;
    add_warnings(warnings, CalibratedSource::warnings());
    return warnings;
  }

 private:
  PhoneSource(OpenedRecording opened, const PhoneSettings& settings)
      : CalibratedSource(std::move(opened.recording), settings.path, settings.skips_bad_frames()),
        warnings_(std::move(opened.warnings)) {}

  Warnings warnings_;
};

}  // namespace

HOLDFAST_PLUGIN(phone, registry) {
  registry.add<FrameSource, PhoneSource, PhoneSettings>(
      {.name = "phone",
       .summary = "Recordings of phones with a depth sensor: Record3D, NeRFCapture and Nerfstudio, Stray Scanner.",
       .paper = ""});
}

}  // namespace holdfast
