// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/calibrated_recording.hpp"
#include "holdfast/image_files/recorded_frames.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace holdfast {

namespace {

struct FourSeasonsSettings : RecordedFrames {
  std::filesystem::path path;
  std::string cameras = "auto";
  std::filesystem::path calibration;

  static void describe(ParameterTable<FourSeasonsSettings>& table) {
    table
        .add("path", &FourSeasonsSettings::path,
             "folder of a sequence, with times.txt and the folder undistorted_images")
        .required();
    table
        .add("cameras", &FourSeasonsSettings::cameras,
             "pair: cam0 and cam1; left: cam0 alone; auto: pair if there is a cam1")
        .one_of({"auto", "pair", "left"});
    table.add("calibration", &FourSeasonsSettings::calibration,
              "folder with undistorted_calib_0.txt; empty = calibration in the folder of the sequence or beside it");
    add_rows(table, "frame");
  }
};

/// A sequence of 4Seasons (Wenzel et al., GCPR 2020): undistorted stereo pairs, or one camera.
class FourSeasonsSource final : public CalibratedSource {
 public:
  FourSeasonsSource(const FourSeasonsSettings& s, const CreationContext& context)
      : CalibratedSource(
            read_four_seasons_recording({s.path, s.cameras, s.calibration, {s.start, s.frames}, context.imu}), s.path,
            s.skips_bad_frames()) {}
};

}  // namespace

HOLDFAST_PLUGIN(four_seasons, registry) {
  registry.add<FrameSource, FourSeasonsSource, FourSeasonsSettings>(
      {.name = "four_seasons",
       .summary = "A sequence of the 4Seasons data: undistorted stereo pairs on roads, or one camera.",
       .paper = "Wenzel, Wang, Yang, Cheng, Khan, von Stumberg, Zeller, Cremers: 4Seasons: A cross-season dataset for "
                "multi-weather SLAM in autonomous driving. GCPR 2020"});
}

}  // namespace holdfast
