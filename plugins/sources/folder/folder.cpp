// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/core/folder_name.hpp"
#include "holdfast/image_files/camera_file.hpp"
#include "holdfast/image_files/frame_poses.hpp"
#include "holdfast/image_files/image_sequence.hpp"
#include "holdfast/image_files/numbered_files.hpp"
#include "holdfast/image_files/recorded_frames.hpp"
#include "holdfast/image_files/recorded_imu.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace holdfast {

namespace {

struct FolderSettings : RecordedFrames {
  std::filesystem::path path;
  std::string colour = "colour";
  std::string depth;
  std::string right;
  double depth_factor = 5000.0;
  bool scale_depth = false;
  int invalid_depth = DepthEncoding::largest;
  double frame_rate = 30.0;
  std::filesystem::path stamps;
  std::filesystem::path truth;
  std::filesystem::path intrinsics;
  std::filesystem::path imu;

  static void describe(ParameterTable<FolderSettings>& table) {
    table.add("path", &FolderSettings::path, "folder of the recording").required();
    table.add("colour", &FolderSettings::colour,
              "colour images under path: a folder of numbered images, or a pattern such as 'colour/%06d.png'");
    table.add("depth", &FolderSettings::depth,
              "depth images under path, 16-bit PNG with the numbers of the colour images: a folder, or a pattern where "
              "colour is one; empty = no depth");
    table.add(
        "right", &FolderSettings::right,
        "images of the right camera of a stereo pair under path, with the numbers of the colour images, which are "
        "the left ones: a folder, or a pattern where colour is one; empty = one camera. Rectified, or with the key "
        "'right' of the intrinsics");
    table.add("depth_factor", &FolderSettings::depth_factor, "value of one metre in a depth image").range(1.0, 65535.0);
    table.add("scale_depth", &FolderSettings::scale_depth,
              "scale depth images to the size of the colour images, for cameras that show the same view");
    table
        .add("invalid_depth", &FolderSettings::invalid_depth,
             "value of pixels without a measurement in a depth image, besides 0")
        .range(0, 65535);
    table.add("frame_rate", &FolderSettings::frame_rate, "frame rate, if no time stamps are given")
        .range(0.001, 100000.0)
        .unit("Hz");
    table.add("stamps", &FolderSettings::stamps,
              "file with one time stamp per line for each colour image, instead of frame_rate");
    table.add("truth", &FolderSettings::truth,
              "ground truth: a trajectory in TUM format, or poses of the images: lines of 4 x 4 or 3 x 4 matrices, a "
              "folder or a pattern of files with one matrix each, .npy, or .json of Nerfstudio or Record3D");
    table.add(
        "intrinsics", &FolderSettings::intrinsics,
        "YAML or JSON file with fx, fy, cx, cy, width, height and, for a lens with distortion, k1 to k6, p1, p2, lens; "
        "'right' is the right camera of a pair that is not rectified. If the configuration has a camera too, both must "
        "agree");
    table.add(
        "imu", &FolderSettings::imu,
        "file of inertial measurements under path, lines 'time stamp, angular velocity x, y, z [rad/s], specific force "
        "x, "
        "y, z [m/s^2]', stamps in seconds or nanoseconds; empty = an imu.csv that Holdfast wrote, if there is one");
    add_rows(table, "frame");
  }
};

/// The images under `name`, a folder or a pattern as the colour images are, that belong to them.
std::vector<std::filesystem::path> find_others(const FolderSettings& settings, const std::vector<NumberedFile>& colour,
                                               const std::string& name, const char* extension) {
  const bool is_pattern = NumberPattern::is_pattern(settings.colour);
  if (NumberPattern::is_pattern(name) != is_pattern)
    throw InputError({(settings.path / name).string()}, std::string("is a ") + (is_pattern ? "folder" : "pattern") +
                                                            ", but the colour images '" + settings.colour + "' are a " +
                                                            (is_pattern ? "pattern" : "folder") +
                                                            "; expected two patterns or two folders");
  if (!is_pattern) return find_partners(colour, settings.path / name, extension);
  const NumberPattern pattern(settings.path, name);
  pattern.find();  // says so when the pattern fits no file at all
  std::vector<std::filesystem::path> files;
  for (const NumberedFile& file : colour) files.push_back(pattern.path_of(file.numbers.front()));
  return files;
}

/// The images of a recording, and their numbers for the poses.
struct FolderFrames {
  std::vector<ImageFiles> files;
  std::vector<NumberedFrame> numbered;  ///< one for each of `files`
  std::size_t image_count = 0;          ///< before the range was selected
};

FolderFrames find_frames(const FolderSettings& settings) {
  require_recording_folder(settings.path, "the folder of a recording", "source.folder.path");
  const bool is_pattern = NumberPattern::is_pattern(settings.colour);
  const std::vector<NumberedFile> colour = is_pattern ? NumberPattern(settings.path, settings.colour).find()
                                                      : find_numbered_files(settings.path / settings.colour);
  std::vector<ImageFiles> files(colour.size());
  for (std::size_t i = 0; i < files.size(); ++i) files[i].colour = colour[i].path;
  const auto add = [&](const std::string& name, const char* extension, std::filesystem::path ImageFiles::*member) {
    if (name.empty()) return;
    const std::vector<std::filesystem::path> others = find_others(settings, colour, name, extension);
    for (std::size_t i = 0; i < files.size(); ++i) files[i].*member = others[i];
  };
  add(settings.depth, ".png", &ImageFiles::depth);
  add(settings.right, "", &ImageFiles::right);
  set_stamps(files, settings.stamps, settings.frame_rate);
  FolderFrames frames;
  frames.image_count = files.size();
  for (std::size_t i = 0; i < files.size(); ++i) frames.numbered.push_back({files[i].timestamp, i, colour[i].numbers});
  select_range(files, settings.start, settings.frames, settings.path, "frames");
  select_range(frames.numbered, settings.start, settings.frames, settings.path, "frames");
  frames.files = std::move(files);
  return frames;
}

/// The camera that a recording brings, and how its pairs are rectified.
struct FolderCamera {
  std::optional<Camera> camera;
  std::shared_ptr<const StereoRectification> rectification;
};

FolderCamera read_camera(const FolderSettings& settings, const Camera& configured) {
  if (settings.intrinsics.empty()) return {};
  CameraFile file = read_camera_file(settings.intrinsics, configured, "source.folder.intrinsics");
  if (settings.stamps.empty()) file.camera.frame_rate = settings.frame_rate;
  if (settings.right.empty() || !file.pair) return {file.camera, nullptr};
  if (!settings.depth.empty())
    throw InputError({settings.intrinsics.string()},
                     "has a camera 'right', to which both images are rectified, and `depth` gives depth images, which "
                     "are not; expected one of the two; leave out `depth`, or the key 'right'");
  file.pair->left.frame_rate = file.camera.frame_rate;
  try {
    const auto rectification = std::make_shared<const StereoRectification>(*file.pair);
    return {rectification->camera(), rectification};
  } catch (const Error& error) {
    throw InputError({settings.intrinsics.string()}, error.what());
  }
}

struct FolderRecording {
  FolderCamera own;
  FolderFrames frames;
};

ImageSequenceOptions options_of(const FolderSettings& settings, const FolderCamera& own, const Camera& configured) {
  const Camera& camera = own.camera ? *own.camera : configured;
  ImageSequenceOptions options{
      {settings.depth_factor, settings.invalid_depth}, camera.width, camera.height, settings.skips_bad_frames()};
  options.invalid_depth_key = "source.folder.invalid_depth";
  options.rectification = own.rectification;
  options.scales_depth = settings.scale_depth;
  options.stamps_are_read = !settings.stamps.empty();
  return options;
}

/// Numbered images in folders.
class FolderSource final : public ImageSequenceSource {
 public:
  FolderSource(const FolderSettings& settings, const CreationContext& context)
      : FolderSource(settings, context, {read_camera(settings, context.camera), find_frames(settings)}) {}

 private:
  FolderSource(const FolderSettings& settings, const CreationContext& context, const FolderRecording& recording)
      : ImageSequenceSource(recording.frames.files, options_of(settings, recording.own, context.camera)) {
    description_.name = folder_name(settings.path);
    description_.camera = recording.own.camera;
    description_.has_depth = !settings.depth.empty();
    description_.has_right = !settings.right.empty();
    const FolderFrames& frames = recording.frames;
    if (!settings.truth.empty()) truth_ = read_frame_poses(settings.truth, frames.numbered, frames.image_count);
    std::optional<ImuCalibration> imu = context.imu;
    if (const StereoRectification* rectification = recording.own.rectification.get()) {
      // Calibration and truth are those of the left camera as it is; the description is of the rectified one.
      const Eigen::Isometry3d T_left_rectified = rectification->T_left_rectified();
      if (imu) imu->T_body_camera = imu->T_body_camera * T_left_rectified;
      for (TimedPose& pose : truth_) pose.T_world_camera = pose.T_world_camera * T_left_rectified;
      if (!truth_.empty()) description_.truth_frame = "transformed";
    }
    read_imu(find_imu_file(settings.path, settings.imu), imu);
  }
};

}  // namespace

HOLDFAST_PLUGIN(folder, registry) {
  registry.add<FrameSource, FolderSource, FolderSettings>(
      {.name = "folder",
       .summary = "Numbered images in folders: one camera, colour with depth, or stereo pairs.",
       .paper = ""});
}

}  // namespace holdfast
