// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/image_files/calibrated_recording.hpp"
#include "holdfast/image_files/openloris_files.hpp"
#include "holdfast/image_files/recording_pairs.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;

/// The files of one choice of cameras.
struct OpenLorisCameras {
  const char* list;           ///< of the first camera
  const char* second_list;    ///< nullptr: one camera
  const char* sensor;         ///< of the first camera, in sensors.yaml
  const char* second_sensor;  ///< of the right camera of a pair, or nullptr
  const char* kinds;          ///< of images, for errors
};

constexpr OpenLorisCameras rgbd_cameras = {"color.txt", "aligned_depth.txt", "d400_color_optical_frame", nullptr,
                                           "colour and depth"};
constexpr OpenLorisCameras colour_camera = {"color.txt", nullptr, "d400_color_optical_frame", nullptr, "colour"};
constexpr OpenLorisCameras fisheye_pair = {"fisheye1.txt", "fisheye2.txt", "t265_fisheye1_optical_frame",
                                           "t265_fisheye2_optical_frame", "left and right"};
constexpr OpenLorisCameras left_fisheye = {"fisheye1.txt", nullptr, "t265_fisheye1_optical_frame", nullptr, "fisheye"};

OpenLorisCameras choose_cameras(const OpenLorisOptions& options) {
  if (options.cameras == "stereo") return fisheye_pair;
  if (options.cameras == "left") return left_fisheye;
  std::error_code error;
  if (fs::exists(options.path / rgbd_cameras.second_list, error)) return rgbd_cameras;
  if (options.colour_is_enough) return colour_camera;
  throw InputError({(options.path / rgbd_cameras.second_list).string()},
                   "is missing; expected the list of the depth images that are registered to the colour images, which "
                   "those of depth.txt are not; make it by align_depth.py of OpenLORIS-Scene's tools, or set `sensor: "
                   "mono` to use the colour images alone");
}

ImageFiles first_image(const fs::path& folder, const char* list, const ListedImage& image) {
  ImageFiles files;
  files.timestamp = image.timestamp;
  files.colour = folder / image.name;
  files.colour_listed_at = {(folder / list).string(), image.line};
  return files;
}

std::vector<ImageFiles> find_openloris_frames(const OpenLorisOptions& options, const OpenLorisCameras& cameras) {
  const fs::path& folder = options.path;
  std::vector<ImageFiles> frames;
  if (cameras.second_list == nullptr) {
    for (const ListedImage& image : read_image_list(folder / cameras.list))
      frames.push_back(first_image(folder, cameras.list, image));
    return frames;
  }
  for (const ListedPair& pair : associate_lists(folder / cameras.list, folder / cameras.second_list,
                                                options.max_time_difference, cameras.kinds)) {
    ImageFiles& files = frames.emplace_back(first_image(folder, cameras.list, pair.colour));
    const SourceLocation second_place = {(folder / cameras.second_list).string(), pair.depth.line};
    if (cameras.second_sensor == nullptr) {
      files.depth = folder / pair.depth.name;
      files.depth_delay = pair.depth.timestamp - pair.colour.timestamp;
      files.depth_listed_at = second_place;
    } else {
      files.right = folder / pair.depth.name;
      files.right_listed_at = second_place;
    }
  }
  return frames;
}

}  // namespace

CalibratedRecording read_openloris_recording(const OpenLorisOptions& options) {
  require_recording_folder(options.path, "the folder of a sequence of OpenLORIS-Scene, with sensors.yaml",
                           "source.openloris.path");
  const OpenLorisCameras cameras = choose_cameras(options);
  const fs::path sensors = options.path / "sensors.yaml", poses = options.path / "trans_matrix.yaml";
  CalibratedRecording recording;
  recording.camera = read_openloris_camera(sensors, cameras.sensor);
  recording.left_size = recording.right_size = {recording.camera.width, recording.camera.height};
  Eigen::Isometry3d T_left_camera = Eigen::Isometry3d::Identity();
  if (cameras.second_sensor != nullptr) {
    const Camera right = read_openloris_camera(sensors, cameras.second_sensor);
    const Eigen::Isometry3d T_base_left = read_openloris_pose(poses, cameras.sensor);
    const Eigen::Isometry3d T_base_right = read_openloris_pose(poses, cameras.second_sensor);
    rectify_pair(recording, right, T_base_left.inverse() * T_base_right, sensors);
    T_left_camera = recording.rectification->T_left_rectified();
  }
  recording.has_global_shutter = options.cameras != "rgbd";
  recording.files = find_openloris_frames(options, cameras);
  if (!recording.files.front().depth.empty()) recording.depth = options.depth;
  recording.invalid_depth_key = "source.openloris.invalid_depth";
  std::error_code error;
  if (const fs::path truth = options.path / "groundtruth.txt"; fs::exists(truth, error)) {
    const Eigen::Isometry3d T_base_camera = read_openloris_pose(poses, cameras.sensor) * T_left_camera;
    recording.truth = read_trajectory(truth);
    for (TimedPose& pose : recording.truth) pose.T_world_camera = pose.T_world_camera * T_base_camera;
    recording.truth_frame = "transformed";
  }
  select_range(recording.files, options.range.start, options.range.frames, options.path,
               cameras.second_list == nullptr ? "images" : "pairs of images");
  return recording;
}

}  // namespace holdfast
