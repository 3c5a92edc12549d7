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

/// The cameras that are read, and whether the right one is among them.
std::pair<Pair, bool> find_pair(const KittiOptions& options) {
  require_recording_folder(options.path, "the folder of a KITTI sequence", "source.kitti.path");
  std::error_code error;
  const auto has = [&](const char* folder) { return std::filesystem::is_directory(options.path / folder, error); };
  for (const Pair& pair : pairs) {
    if (options.cameras == pair.name) return {pair, has(pair.right) || !options.left_is_enough};
    if (options.cameras == "auto" && has(pair.left) && has(pair.right)) return {pair, true};
  }
  for (const Pair& pair : pairs)
    if (has(pair.left)) return {pair, false};
  throw InputError({options.path.string()},
                   "has neither a stereo pair nor a left camera; expected the folders image_2 and image_3, image_0 and "
                   "image_1, left and right, or the first of two");
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
std::pair<Camera, Eigen::Vector3d> read_camera(const KittiOptions& options, const Pair& pair, bool has_right,
                                               const cv::Size& size) {
  const std::filesystem::path file = options.path / "calib.txt";
  const std::vector<KittiProjection> projections = read_kitti_calibration(file, has_right ? 2 : 1);
  if (projections.size() < pair.left_matrix + (has_right ? 2 : 1))
    throw InputError({file.string()}, "has " + std::to_string(projections.size()) +
                                          " projection matrices; expected P2 and P3 for the colour cameras");
  const KittiProjection& left = projections[pair.left_matrix];
  Camera camera;
  camera.width = size.width, camera.height = size.height;
  camera.fx = left(0, 0), camera.fy = left(1, 1), camera.cx = left(0, 2), camera.cy = left(1, 2);
  const Eigen::Vector3d position(-left(0, 3) / camera.fx, 0.0, 0.0);
  if (!has_right) return {camera, position};
  const KittiProjection& right = projections[pair.left_matrix + 1];
  camera.baseline = (left(0, 3) - right(0, 3)) / camera.fx;
  if (left.leftCols<3>() != right.leftCols<3>() || !(camera.baseline > 0.0))
    throw InputError({file.string()},
                     "does not have the matrices of a rectified pair, left before right; expected equal intrinsics "
                     "and a right camera further right");
  return {camera, position};
}

}  // namespace

CalibratedRecording read_kitti_recording(const KittiOptions& options) {
  const auto [pair, has_right] = find_pair(options);
  CalibratedRecording recording;
  recording.has_right = has_right;
  std::vector<ImageFiles>& files = recording.files;
  const std::vector<NumberedFile> left = find_numbered_files(options.path / pair.left);
  files.resize(left.size());
  for (std::size_t i = 0; i < files.size(); ++i) files[i].colour = left[i].path;
  if (has_right) {
    const std::vector<std::filesystem::path> right = find_partners(left, options.path / pair.right);
    for (std::size_t i = 0; i < files.size(); ++i) files[i].right = right[i];
  }
  std::error_code error;
  const std::filesystem::path times = options.path / "times.txt";
  set_stamps(files, std::filesystem::exists(times, error) ? times : std::filesystem::path(), options.frame_rate);
  recording.truth = read_truth(options, files);
  select_range(files, options.range.start, options.range.frames, options.path, "frames");

  cv::Size size;
  ImageDecoder().read_grey(files.front().colour, [&](const cv::Size& of_image) { size = of_image; });
  recording.left_size = recording.right_size = size;
  Eigen::Vector3d position;
  std::tie(recording.camera, position) = read_camera(options, pair, has_right, size);
  // The poses are those of the reference camera, beside which this camera stands.
  for (TimedPose& pose : recording.truth) pose.T_world_camera = pose.T_world_camera * Eigen::Translation3d(position);
  if (files.size() > 1)
    recording.camera.frame_rate =
        static_cast<double>(files.size() - 1) / (files.back().timestamp - files.front().timestamp);
  return recording;
}

}  // namespace holdfast
