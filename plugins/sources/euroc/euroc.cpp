// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/calibrated_recording.hpp"
#include "holdfast/image_files/recorded_frames.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace holdfast {

namespace {

struct EurocSettings : RecordedFrames {
  std::filesystem::path path;
  std::string cameras = "auto";
  double max_time_difference = 0.002;
  std::string imu = "auto";

  static void describe(ParameterTable<EurocSettings>& table) {
    table.add("path", &EurocSettings::path, "folder of a sequence, which contains mav0, or mav0 itself").required();
    table
        .add("cameras", &EurocSettings::cameras,
             "pair: cam0 and cam1, rectified; left: cam0 alone, as it is; auto: pair if there is a cam1")
        .one_of({"auto", "pair", "left"});
    table
        .add("max_time_difference", &EurocSettings::max_time_difference,
             "upper bound of the time difference between the two images of a pair")
        .range(1e-6, 1.0)
        .unit("s");
    table
        .add("imu", &EurocSettings::imu,
             "auto: inertial measurements of imu0, if it exists, with the calibration of its sensor.yaml unless the "
             "configuration has the section 'imu'; none: they are not read")
        .one_of({"auto", "none"});
    add_rows(table, "frame");
  }
};

/// A sequence in the ASL layout of the EuRoC MAV data (Burri et al. 2016): stereo pairs, or one camera.
class EurocSource final : public CalibratedSource {
 public:
  EurocSource(const EurocSettings& s, const CreationContext& context)
      : CalibratedSource(
            read_euroc_recording(
                {s.path, s.cameras, s.max_time_difference, {s.start, s.frames}, s.imu == "auto", context.imu}),
            s.path, s.skips_bad_frames()) {}
};

}  // namespace

HOLDFAST_PLUGIN(euroc, registry) {
  registry.add<FrameSource, EurocSource, EurocSettings>(
      {.name = "euroc",
       .summary =
           "A sequence in the ASL layout of the EuRoC MAV data: stereo pairs, which are rectified, or one camera.",
       .paper = "Burri, Nikolic, Gohl, Schneider, Rehder, Omari, Achtelik, Siegwart: The EuRoC micro aerial vehicle "
                "datasets. IJRR 2016"});
}

}  // namespace holdfast
