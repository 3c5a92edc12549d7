// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <map>
#include <optional>
#include <span>

#include "holdfast/core/error.hpp"
#include "holdfast/core/parsed_number.hpp"
#include "holdfast/core/size_text.hpp"
#include "holdfast/image_files/calibrated_recording.hpp"
#include "holdfast/image_files/kitti_files.hpp"
#include "holdfast/image_files/kitti_raw_files.hpp"
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
constexpr std::array<Pair, 3> odometry_pairs = {
    {{"colour", "image_2", "image_3", 2}, {"grey", "image_0", "image_1", 0}, {"pair", "left", "right", 0}}};
constexpr std::array<Pair, 2> raw_pairs = {
    {{"colour", "image_02/data", "image_03/data", 2}, {"grey", "image_00/data", "image_01/data", 0}}};

/// The cameras that are read.
struct KittiCameras {
  Pair pair;
  bool has_right = false;
  bool is_raw = false;  ///< of a drive of the raw data
};

KittiCameras find_kitti_cameras(const KittiOptions& options) {
  require_recording_folder(options.path, "the folder of a KITTI sequence", "source.kitti.path");
  std::error_code error;
  const auto has = [&](const char* folder) { return std::filesystem::is_directory(options.path / folder, error); };
  const bool is_raw = has("oxts") || has(raw_pairs[0].left) || has(raw_pairs[1].left);
  const std::span<const Pair> pairs = is_raw ? std::span<const Pair>(raw_pairs) : odometry_pairs;
  for (const Pair& pair : pairs) {
    if (options.cameras == pair.name) return {pair, has(pair.right) || !options.left_is_enough, is_raw};
    if (options.cameras == "auto" && has(pair.left) && has(pair.right)) return {pair, true, is_raw};
  }
  for (const Pair& pair : pairs)
    if (has(pair.left)) return {pair, false, is_raw};
  throw InputError({options.path.string()},
                   std::string("has neither a stereo pair nor a left camera; expected the folders ") +
                       (is_raw ? "image_02 and image_03, or image_00 and image_01, each with a folder data"
                               : "image_2 and image_3, image_0 and image_1, left and right") +
                       ", or the first of two");
}

/// The truth of the reference camera, from a file with a pose of each frame.
Trajectory read_kitti_truth(const KittiOptions& options, const std::vector<ImageFiles>& files) {
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

/// Folder of calib_cam_to_cam.txt: that of the drive, or of its day.
std::filesystem::path day_folder(const KittiOptions& options) {
  std::error_code error;
  const std::filesystem::path drive = std::filesystem::weakly_canonical(options.path, error);
  for (const std::filesystem::path& folder : {drive, drive.parent_path()})
    if (std::filesystem::exists(folder / "calib_cam_to_cam.txt", error)) return folder;
  throw InputError({(drive.parent_path() / "calib_cam_to_cam.txt").string()},
                   "is missing; expected the calibration of the day beside the folder of the drive, or in it; it is an "
                   "archive of its own among the raw data");
}

/// The truth of the rectified reference camera, from the poses of the inertial navigation system.
Trajectory read_oxts_truth(const KittiOptions& options, const std::vector<NumberedFile>& images,
                           const std::vector<ImageFiles>& files, const Eigen::Matrix3d& rectification) {
  const std::filesystem::path folder = options.path / "oxts" / "data", calibration = day_folder(options);
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) return {};
  Eigen::Isometry3d T_rectified_camera = Eigen::Isometry3d::Identity();
  T_rectified_camera.linear() = rectification;
  const Eigen::Isometry3d T_camera_imu = T_rectified_camera *
                                         read_kitti_transform(calibration / "calib_velo_to_cam.txt") *
                                         read_kitti_transform(calibration / "calib_imu_to_velo.txt");
  std::map<FileNumbers, std::filesystem::path> packets;
  for (NumberedFile& packet : find_numbered_files(folder, ".txt")) packets[packet.numbers] = std::move(packet.path);
  Trajectory truth;
  std::optional<KittiMercator> projection;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const auto found = packets.find(images[i].numbers);
    if (found == packets.end()) continue;
    const KittiOxts packet = read_kitti_oxts(found->second);
    if (!projection) projection.emplace(packet);
    truth.push_back({files[i].timestamp, projection->pose(packet) * T_camera_imu.inverse()});
  }
  if (truth.empty())
    throw InputError({folder.string()}, "has no file with the number of an image, such as '" +
                                            images.front().path.stem().string() + ".txt'; unpack the drive again");
  return truth;
}

/// Matrices of the cameras, and what turns the reference camera to its rectified one.
KittiRawCalibration kitti_calibration(const KittiOptions& options, const KittiCameras& cameras) {
  if (cameras.is_raw) return read_kitti_raw_calibration(day_folder(options) / "calib_cam_to_cam.txt");
  KittiRawCalibration calibration;
  calibration.file = options.path / "calib.txt";
  calibration.projections = read_kitti_calibration(calibration.file, cameras.has_right ? 2 : 1);
  return calibration;
}

/// The left camera of the pair, and its position in the frame of the reference camera.
std::pair<Camera, Eigen::Vector3d> make_kitti_camera(const KittiRawCalibration& calibration,
                                                     const KittiCameras& cameras, const cv::Size& size) {
  const std::vector<KittiProjection>& projections = calibration.projections;
  const std::size_t first = cameras.pair.left_matrix;
  if (projections.size() < first + (cameras.has_right ? 2 : 1))
    throw InputError({calibration.file.string()},
                     "has " + std::to_string(projections.size()) +
                         " projection matrices; expected P2 and P3 for the colour cameras");
  const KittiProjection& left = projections[first];
  Camera camera;
  camera.width = size.width, camera.height = size.height;
  camera.fx = left(0, 0), camera.fy = left(1, 1), camera.cx = left(0, 2), camera.cy = left(1, 2);
  const Eigen::Vector3d position(-left(0, 3) / camera.fx, 0.0, 0.0);
  if (!cameras.has_right) return {camera, position};
  const KittiProjection& right = projections[first + 1];
  camera.baseline = (left(0, 3) - right(0, 3)) / camera.fx;
  if (left.leftCols<3>() != right.leftCols<3>() || !(camera.baseline > 0.0))
    throw InputError({calibration.file.string()},
                     "does not have the matrices of a rectified pair, left before right; expected equal intrinsics "
                     "and a right camera further right");
  return {camera, position};
}

/// Images that were not rectified have another size than the calibration's rectified ones.
void require_rectified(const KittiRawCalibration& calibration, const KittiCameras& cameras, const cv::Size& size,
                       const std::filesystem::path& image) {
  if (!cameras.is_raw || size == calibration.sizes[cameras.pair.left_matrix]) return;
  const cv::Size& expected = calibration.sizes[cameras.pair.left_matrix];
  throw InputError({image.string()}, "has " + size_text(size.width, size.height) + " pixels; expected the " +
                                         size_text(expected.width, expected.height) + " of a rectified image by " +
                                         calibration.file.string() +
                                         "; take the archive whose name ends in _sync, not _extract");
}

/// Stamps by the numbers of the images, which count the lines of the file from 0.
void set_raw_stamps(const KittiOptions& options, const KittiCameras& cameras, const std::vector<NumberedFile>& images,
                    std::vector<ImageFiles>& files) {
  const std::filesystem::path file = (options.path / cameras.pair.left).parent_path() / "timestamps.txt";
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return set_stamps(files, {}, options.frame_rate);
  const std::vector<double> stamps = read_kitti_stamps(file);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto number = parsed_number<std::size_t>(images[i].numbers.back());
    if (!number || *number >= stamps.size())
      throw InputError({file.string()}, "has " + std::to_string(stamps.size()) + " stamps, but there is an image '" +
                                            images[i].path.filename().string() +
                                            "'; expected a line for each number, from 0");
    files[i].timestamp = stamps[*number];
  }
}

}  // namespace

CalibratedRecording read_kitti_recording(const KittiOptions& options) {
  const KittiCameras cameras = find_kitti_cameras(options);
  CalibratedRecording recording;
  recording.has_right = cameras.has_right;
  std::vector<ImageFiles>& files = recording.files;
  const std::vector<NumberedFile> left = find_numbered_files(options.path / cameras.pair.left);
  files.resize(left.size());
  for (std::size_t i = 0; i < files.size(); ++i) files[i].colour = left[i].path;
  if (cameras.has_right) {
    const std::vector<std::filesystem::path> right = find_partners(left, options.path / cameras.pair.right);
    for (std::size_t i = 0; i < files.size(); ++i) files[i].right = right[i];
  }
  const KittiRawCalibration calibration = kitti_calibration(options, cameras);
  if (cameras.is_raw) {
    set_raw_stamps(options, cameras, left, files);
  } else {
    std::error_code error;
    const std::filesystem::path times = options.path / "times.txt";
    set_stamps(files, std::filesystem::exists(times, error) ? times : std::filesystem::path(), options.frame_rate);
  }
  recording.truth = cameras.is_raw && options.poses.empty()
                        ? read_oxts_truth(options, left, files, calibration.rectification)
                        : read_kitti_truth(options, files);
  select_range(files, options.range.start, options.range.frames, options.path, "frames");

  cv::Size size;
  ImageDecoder().read_grey(files.front().colour, [&](const cv::Size& of_image) { size = of_image; });
  require_rectified(calibration, cameras, size, files.front().colour);
  recording.left_size = recording.right_size = size;
  Eigen::Vector3d position;
  std::tie(recording.camera, position) = make_kitti_camera(calibration, cameras, size);
  // The poses are those of the reference camera, beside which this camera stands.
  for (TimedPose& pose : recording.truth) pose.T_world_camera = pose.T_world_camera * Eigen::Translation3d(position);
  if (cameras.is_raw && options.poses.empty()) recording.truth_frame = "transformed";
  measure_frame_rate(recording);
  return recording;
}

}  // namespace holdfast
