// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <utility>

#include "holdfast/core/folder_name.hpp"
#include "holdfast/image_files/image_list.hpp"
#include "holdfast/image_files/image_sequence.hpp"
#include "holdfast/image_files/kitti_files.hpp"
#include "holdfast/image_files/numbered_files.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace holdfast {

namespace {

struct KittiSettings {
  std::filesystem::path path;
  std::string cameras = "auto";
  std::filesystem::path poses;
  double frame_rate = 10.0;
  std::string on_bad_frame = "fail";
  std::int64_t start = 0;
  std::int64_t frames = 0;

  static void describe(ParameterTable<KittiSettings>& table) {
    table
        .add("path", &KittiSettings::path,
             "folder of a sequence, with calib.txt and the folders of a rectified stereo pair: image_2 and image_3, "
             "image_0 and image_1, or left and right")
        .required();
    table
        .add("cameras", &KittiSettings::cameras,
             "colour: image_2 and image_3; grey: image_0 and image_1; pair: left and right; auto: the first of these "
             "that exists")
        .one_of({"auto", "colour", "grey", "pair"});
    table.add("poses", &KittiSettings::poses,
              "ground truth in KITTI's format; empty = poses.txt in the folder, or poses/NAME.txt beside its parent, "
              "as in the data set, if there is one");
    table.add("frame_rate", &KittiSettings::frame_rate, "frame rate, if the folder has no times.txt")
        .range(0.001, 100000.0)
        .unit("Hz");
    table
        .add("on_bad_frame", &KittiSettings::on_bad_frame,
             "reaction to a missing, damaged or unsuitable image: stop with an error, or skip and count the frame")
        .one_of({"fail", "skip"});
    table.add("start", &KittiSettings::start, "index of the first frame, from 0").at_least(0);
    table.add("frames", &KittiSettings::frames, "number of frames, 0 = all").at_least(0);
  }
};

/// The folders of a stereo pair, and the places of its matrices in calib.txt.
struct Pair {
  const char* name;
  const char* left;
  const char* right;
  std::size_t left_matrix;
};
constexpr std::array<Pair, 3> pairs = {
    {{"colour", "image_2", "image_3", 2}, {"grey", "image_0", "image_1", 0}, {"pair", "left", "right", 0}}};

Pair find_pair(const KittiSettings& settings) {
  std::error_code error;
  if (!std::filesystem::is_directory(settings.path, error))
    throw InputError({settings.path.string()},
                     std::string(std::filesystem::exists(settings.path, error) ? "is not a folder" : "is missing") +
                         "; expected the folder of a KITTI sequence; set `source.kitti.path`");
  for (const Pair& pair : pairs) {
    if (settings.cameras == pair.name) return pair;
    if (settings.cameras == "auto" && std::filesystem::is_directory(settings.path / pair.left, error) &&
        std::filesystem::is_directory(settings.path / pair.right, error))
      return pair;
  }
  throw InputError({settings.path.string()},
                   "has no stereo pair; expected the folders image_2 and image_3, image_0 and image_1, or left and "
                   "right");
}

/// A sequence of the KITTI odometry data (Geiger et al. 2012): rectified stereo pairs.
class KittiSource final : public FrameSource {
 public:
  KittiSource(const KittiSettings& settings, const CreationContext&)
      : pair_(find_pair(settings)), files_(find_files(settings)), sequence_(open(settings)) {
    description_.frame_count = sequence_.size();
  }

  SourceDescription describe() const override { return description_; }
  std::optional<SensorFrame> next() override { return sequence_.next(); }
  Trajectory truth() const override { return truth_; }
  std::vector<SkippedFrame> skipped() const override { return sequence_.skipped(); }

 private:
  std::vector<ImageFiles> find_files(const KittiSettings& settings) {
    const std::vector<NumberedFile> left = find_numbered_files(settings.path / pair_.left);
    const std::vector<NumberedFile> right = find_numbered_files(settings.path / pair_.right);
    std::vector<ImageFiles> files(left.size());
    std::size_t next = 0;
    for (std::size_t i = 0; i < files.size(); ++i) {
      files[i].colour = left[i].path;
      while (next < right.size() && comes_before(right[next].numbers, left[i].numbers)) ++next;
      const bool found = next < right.size() && right[next].numbers == left[i].numbers;
      // A right image that is not there gets the name that it should have, so that the frame is bad and says so.
      files[i].right = found ? right[next].path : settings.path / pair_.right / left[i].path.filename();
    }
    set_stamps(settings, files);
    read_truth(settings, files);
    select_range(files, settings.start, settings.frames, settings.path, "frames");
    return files;
  }

  static void set_stamps(const KittiSettings& settings, std::vector<ImageFiles>& files) {
    const std::filesystem::path times = settings.path / "times.txt";
    std::error_code error;
    if (!std::filesystem::exists(times, error)) {
      for (std::size_t i = 0; i < files.size(); ++i) files[i].timestamp = static_cast<double>(i) / settings.frame_rate;
      return;
    }
    const std::vector<ListedImage> stamps = read_stamp_list(times);
    if (stamps.size() != files.size())
      throw InputError({times.string(), stamps.back().line},
                       "the file ends with " + std::to_string(stamps.size()) + " stamps, but there are " +
                           std::to_string(files.size()) + " left images; expected one stamp for each");
    for (std::size_t i = 0; i < files.size(); ++i) files[i].timestamp = stamps[i].timestamp;
  }

  void read_truth(const KittiSettings& settings, const std::vector<ImageFiles>& files) {
    std::filesystem::path file = settings.poses;
    std::error_code error;
    if (file.empty()) {
      const std::filesystem::path beside = std::filesystem::weakly_canonical(settings.path, error);
      for (const std::filesystem::path& candidate :
           {settings.path / "poses.txt",
            beside.parent_path().parent_path() / "poses" / (beside.filename().string() + ".txt")})
        if (file.empty() && std::filesystem::exists(candidate, error)) file = candidate;
      if (file.empty()) return;
    }
    const std::vector<Eigen::Isometry3d> poses = read_kitti_poses(file);
    if (poses.size() != files.size())
      throw InputError({file.string()}, "has " + std::to_string(poses.size()) + " poses, but there are " +
                                            std::to_string(files.size()) + " left images; expected one for each");
    for (std::size_t i = 0; i < files.size(); ++i) truth_.push_back({files[i].timestamp, poses[i]});
  }

  ImageSequence open(const KittiSettings& settings) {
    description_.name = folder_name(settings.path);
    description_.has_right = true;
    description_.can_read_ahead = true;
    cv::Size size;
    ImageDecoder().read_grey(files_.front().colour, [&](const cv::Size& of_image) { size = of_image; });
    description_.camera = read_camera(settings, size);
    if (files_.size() > 1) {
      const double duration = files_.back().timestamp - files_.front().timestamp;
      description_.camera->frame_rate = static_cast<double>(files_.size() - 1) / duration;
    }
    ImageSequenceOptions options;
    options.width = size.width;
    options.height = size.height;
    options.colour_may_be_grey = true;
    options.skip_bad_frames = settings.on_bad_frame == "skip";
    return {std::move(files_), options};
  }

  Camera read_camera(const KittiSettings& settings, const cv::Size& size) {
    const std::filesystem::path file = settings.path / "calib.txt";
    const std::vector<KittiProjection> projections = read_kitti_calibration(file);
    if (projections.size() < pair_.left_matrix + 2)
      throw InputError({file.string()}, "has " + std::to_string(projections.size()) +
                                            " projection matrices; expected P2 and P3 for the colour cameras");
    const KittiProjection& left = projections[pair_.left_matrix];
    const KittiProjection& right = projections[pair_.left_matrix + 1];
    const double fx = left(0, 0), baseline = (left(0, 3) - right(0, 3)) / fx;
    if (left.leftCols<3>() != right.leftCols<3>() || !(baseline > 0.0))
      throw InputError({file.string()},
                       "does not have the matrices of a rectified pair, left before right; expected equal intrinsics "
                       "and a right camera further right");
    // The poses are those of the reference camera, in whose frame this camera stands beside the origin.
    for (TimedPose& pose : truth_)
      pose.T_world_camera = pose.T_world_camera * Eigen::Translation3d(-left(0, 3) / fx, 0.0, 0.0);
    Camera camera;
    camera.width = size.width, camera.height = size.height;
    camera.fx = fx, camera.fy = left(1, 1), camera.cx = left(0, 2), camera.cy = left(1, 2);
    camera.baseline = baseline;
    return camera;
  }

  // In the order in which the constructor fills them.
  SourceDescription description_;
  Trajectory truth_;
  Pair pair_;
  std::vector<ImageFiles> files_;
  ImageSequence sequence_;
};

}  // namespace

HOLDFAST_PLUGIN(kitti, registry) {
  registry.add<FrameSource, KittiSource, KittiSettings>(
      {.name = "kitti",
       .summary = "A sequence in the layout of the KITTI odometry data: rectified stereo pairs.",
       .paper = "Geiger, Lenz, Urtasun: Are we ready for Autonomous Driving? The KITTI Vision Benchmark Suite. CVPR "
                "2012"});
}

}  // namespace holdfast
