// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "holdfast/core/error.hpp"
#include "holdfast/image_files/calibrated_recording.hpp"
#include "holdfast/image_files/kitti_files.hpp"
#include "holdfast/image_files/numbered_files.hpp"

namespace holdfast {

namespace {

/// The folders of a stereo pair, and the places of its matrices in calib.txt.
struct Pair {
  const char* name;
  const char* left;
  const char* right;
  std::size_t left_matrix;
};
constexpr std::array<Pair, 3> pairs = {
    {{"colour", "image_2", "image_3", 2}, {"grey", "image_0", "image_1", 0}, {"pair", "left", "right", 0}}};

Pair find_pair(const KittiOptions& options) {
  require_recording_folder(options.path, "the folder of a KITTI sequence", "source.kitti.path");
  std::error_code error;
  for (const Pair& pair : pairs) {
    if (options.cameras == pair.name) return pair;
    if (options.cameras == "auto" && std::filesystem::is_directory(options.path / pair.left, error) &&
        std::filesystem::is_directory(options.path / pair.right, error))
      return pair;
  }
  throw InputError({options.path.string()},
                   "has no stereo pair; expected the folders image_2 and image_3, image_0 and image_1, or left and "
                   "right");
}

/// The truth of the reference camera.
Trajectory read_truth(const KittiOptions& options, const std::vector<ImageFiles>& files) {
  std::filesystem::path file = options.poses;
  std::error_code error;
  if (file.empty()) {
    const std::filesystem::path beside = std::filesystem::weakly_canonical(options.path, error);
    for (const std::filesystem::path& candidate :
         {options.path / "poses.txt",
          beside.parent_path().parent_path() / "poses" / (beside.filename().string() + ".txt")})
      if (file.empty() && std::filesystem::exists(candidate, error)) file = candidate;
    if (file.empty()) return {};
  }
  const std::vector<Eigen::Isometry3d> poses = read_kitti_poses(file);
  if (poses.size() != files.size())
    throw InputError({file.string()}, "has " + std::to_string(poses.size()) + " poses, but there are " +
                                          std::to_string(files.size()) + " left images; expected one for each");
  Trajectory truth;
  for (std::size_t i = 0; i < files.size(); ++i) truth.push_back({files[i].timestamp, poses[i]});
  return truth;
}

/// The left camera of the pair, and its position in the frame of the reference camera.
std::pair<Camera, Eigen::Vector3d> read_camera(const KittiOptions& options, const Pair& pair, const cv::Size& size) {
  const std::filesystem::path file = options.path / "calib.txt";
  const std::vector<KittiProjection> projections = read_kitti_calibration(file);
  if (projections.size() < pair.left_matrix + 2)
    throw InputError({file.string()}, "has " + std::to_string(projections.size()) +
                                          " projection matrices; expected P2 and P3 for the colour cameras");
  const KittiProjection& left = projections[pair.left_matrix];
  const KittiProjection& right = projections[pair.left_matrix + 1];
  const double fx = left(0, 0), baseline = (left(0, 3) - right(0, 3)) / fx;
  if (left.leftCols<3>() != right.leftCols<3>() || !(baseline > 0.0))
    throw InputError({file.string()},
                     "does not have the matrices of a rectified pair, left before right; expected equal intrinsics "
                     "and a right camera further right");
  Camera camera;
  camera.width = size.width, camera.height = size.height;
  camera.fx = fx, camera.fy = left(1, 1), camera.cx = left(0, 2), camera.cy = left(1, 2);
  camera.baseline = baseline;
  return {camera, {-left(0, 3) / fx, 0.0, 0.0}};
}

}  // namespace

CalibratedRecording read_kitti_recording(const KittiOptions& options) {
  const Pair pair = find_pair(options);
  CalibratedRecording recording;
  recording.has_right = true;
  std::vector<ImageFiles>& files = recording.files;
  const std::vector<NumberedFile> left = find_numbered_files(options.path / pair.left);
  const std::vector<std::filesystem::path> right = find_partners(left, options.path / pair.right);
  files.resize(left.size());
  for (std::size_t i = 0; i < files.size(); ++i) files[i].colour = left[i].path, files[i].right = right[i];
  std::error_code error;
  const std::filesystem::path times = options.path / "times.txt";
  set_stamps(files, std::filesystem::exists(times, error) ? times : std::filesystem::path(), options.frame_rate);
  recording.truth = read_truth(options, files);
  select_range(files, options.range.start, options.range.frames, options.path, "frames");

  cv::Size size;
  ImageDecoder().read_grey(files.front().colour, [&](const cv::Size& of_image) { size = of_image; });
  recording.left_size = recording.right_size = size;
  Eigen::Vector3d position;
  std::tie(recording.camera, position) = read_camera(options, pair, size);
  // The poses are those of the reference camera, beside which this camera stands.
  for (TimedPose& pose : recording.truth) pose.T_world_camera = pose.T_world_camera * Eigen::Translation3d(position);
  if (files.size() > 1)
    recording.camera.frame_rate =
        static_cast<double>(files.size() - 1) / (files.back().timestamp - files.front().timestamp);
  return recording;
}

}  // namespace holdfast
