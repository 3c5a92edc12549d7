// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/calibrated_recording.hpp"
#include "holdfast/image_files/recorded_frames.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace holdfast {

namespace {

struct OpenLorisSettings : RecordedFrames {
  std::filesystem::path path;
  std::string cameras = "rgbd";
  double max_time_difference = 0.02;
  double depth_factor = 1000.0;
  int invalid_depth = DepthEncoding::largest;

  static void describe(ParameterTable<OpenLorisSettings>& table) {
    table
        .add("path", &OpenLorisSettings::path,
             "folder of a sequence, with sensors.yaml, trans_matrix.yaml and the lists of the images")
        .required();
    table
        .add("cameras", &OpenLorisSettings::cameras,
             "rgbd: color and aligned_depth of the D435i (with `sensor: mono`, color alone will do); stereo: fisheye1 "
             "and fisheye2 of the T265, rectified; left: fisheye1 alone, as it is")
        .one_of({"rgbd", "stereo", "left"});
    table
        .add("max_time_difference", &OpenLorisSettings::max_time_difference,
             "upper bound of the time difference between the two images of a frame")
        .range(1e-6, 1.0)
        .unit("s");
    table.add("depth_factor", &OpenLorisSettings::depth_factor, "value of one metre in a depth image")
        .range(1.0, 65535.0);
    table
        .add("invalid_depth", &OpenLorisSettings::invalid_depth,
             "value of pixels without a measurement in a depth image, besides 0")
        .range(0, 65535);
    add_rows(table, "frame");
  }
};

OpenLorisOptions options_of(const OpenLorisSettings& settings, const CreationContext& context) {
  OpenLorisOptions options;
  options.path = settings.path;
  options.cameras = settings.cameras;
  options.max_time_difference = settings.max_time_difference;
  options.depth = {settings.depth_factor, settings.invalid_depth};
  options.colour_is_enough = context.sensor == Sensor::mono;
  options.range = {settings.start, settings.frames};
  return options;
}

/// A sequence of OpenLORIS-Scene (Shi et al., ICRA 2020) in its package format: one folder with lists of images.
class OpenLorisSource final : public CalibratedSource {
 public:
  OpenLorisSource(const OpenLorisSettings& settings, const CreationContext& context)
      : CalibratedSource(read_openloris_recording(options_of(settings, context)), settings.path,
                         settings.skips_bad_frames()) {}
};

}  // namespace

HOLDFAST_PLUGIN(openloris, registry) {
  registry.add<FrameSource, OpenLorisSource, OpenLorisSettings>(
      {.name = "openloris",
       .summary = "A sequence of OpenLORIS-Scene in its package format: colour with depth, or fisheye stereo pairs.",
       .paper = "Shi, Li, Zhao, Tian, Tian, Long, Zhu, Song, Qiao, Song, Guo, Wang, Zhang, Qin, Yang, Wang, Chan, She: "
                "Are we ready for service robots? The OpenLORIS-Scene datasets for lifelong SLAM. ICRA 2020"});
}

}  // namespace holdfast
