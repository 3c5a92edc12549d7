// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/calibrated_recording.hpp"
#include "holdfast/image_files/recorded_frames.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace holdfast {

namespace {

struct KittiSettings : RecordedFrames {
  std::filesystem::path path;
  std::string cameras = "auto";
  std::filesystem::path poses;
  double frame_rate = 10.0;

  static void describe(ParameterTable<KittiSettings>& table) {
    table
        .add("path", &KittiSettings::path,
             "folder of a sequence, with calib.txt and the folders of a rectified stereo pair: image_2 and image_3, "
             "image_0 and image_1, or left and right; or of the left camera alone; or a drive of the raw data")
        .required();
    table
        .add("cameras", &KittiSettings::cameras,
             "colour: image_2 and image_3; grey: image_0 and image_1; pair: left and right; auto: the first of these "
             "that exists, or the left camera alone")
        .one_of({"auto", "colour", "grey", "pair"});
    table.add("poses", &KittiSettings::poses,
              "ground truth in KITTI's format; empty = poses.txt in the folder, or poses/NAME.txt beside its parent, "
              "as in the data set, or oxts of raw data, if there is one");
    table.add("frame_rate", &KittiSettings::frame_rate, "frame rate, if there are no time stamps")
        .range(0.001, 100000.0)
        .unit("Hz");
    add_rows(table, "frame");
  }
};

/// A sequence of the KITTI odometry or raw data (Geiger et al. 2012, 2013): rectified stereo pairs, or one camera.
class KittiSource final : public CalibratedSource {
 public:
  KittiSource(const KittiSettings& s, const CreationContext& context)
      : CalibratedSource(
            read_kitti_recording(
                {s.path, s.cameras, s.poses, s.frame_rate, {s.start, s.frames}, context.sensor == Sensor::mono}),
            s.path, s.skips_bad_frames()) {}
};

}  // namespace

HOLDFAST_PLUGIN(kitti, registry) {
  registry.add<FrameSource, KittiSource, KittiSettings>(
      {.name = "kitti",
       .summary = "A sequence in the layout of the KITTI odometry or raw data: rectified stereo pairs, or one camera.",
       .paper = "Geiger, Lenz, Urtasun: Are we ready for Autonomous Driving? The KITTI Vision Benchmark Suite. CVPR "
                "2012"});
}

}  // namespace holdfast
