// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "holdfast/core/association.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/image_files/calibrated_recording.hpp"
#include "holdfast/image_files/euroc_files.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;

std::vector<double> stamps_of(const std::vector<ListedImage>& images) {
  std::vector<double> stamps;
  for (const ListedImage& image : images) stamps.push_back(image.timestamp);
  return stamps;
}

/// The folder mav0 of the recording.
fs::path find_body(const EurocOptions& options) {
  require_recording_folder(options.path, "the folder of a sequence in the ASL layout", "source.euroc.path");
  std::error_code error;
  for (const fs::path& folder : {options.path / "mav0", options.path})
    if (fs::is_directory(folder / "cam0", error)) return folder;
  throw InputError({options.path.string()},
                   "contains neither mav0/cam0 nor cam0; expected a sequence in the ASL layout; unpack it again, or "
                   "correct `source.euroc.path`");
}

/// The calibration of the recording: a sensor.yaml of each sensor, or Kalibr's files in dso/, beside mav0, as TUM VI
/// has them.
class AslCalibration {
 public:
  explicit AslCalibration(const fs::path& body) : body_(body) {
    std::error_code error;
    const fs::path dso = fs::weakly_canonical(body, error).parent_path() / "dso";
    if (!fs::exists(body / "cam0" / "sensor.yaml", error) && fs::exists(dso / "camchain.yaml", error)) kalibr_ = dso;
  }

  bool has_frame_rate() const { return kalibr_.empty(); }
  fs::path file_of(const char* camera) const {
    return kalibr_.empty() ? body_ / camera / "sensor.yaml" : kalibr_ / "camchain.yaml";
  }
  EurocCamera camera(const char* name) const {
    const fs::path file = file_of(name);
    std::error_code error;
    if (!kalibr_.empty()) return read_kalibr_camera(file, name);
    if (!fs::exists(file, error))
      throw InputError({file.string()},
                       "is missing; expected the calibration of the camera, or that of all cameras in "
                       "dso/camchain.yaml beside mav0, as the archives of the TUM VI data have it; unpack it again");
    return read_euroc_camera(file);
  }
  /// With T_body_camera of a camera at the body's origin; nothing without a file.
  std::optional<ImuCalibration> imu() const {
    const fs::path file = kalibr_.empty() ? body_ / "imu0" / "sensor.yaml" : kalibr_ / "imu_config.yaml";
    std::error_code error;
    if (!fs::exists(file, error)) return std::nullopt;
    return kalibr_.empty() ? read_euroc_imu(file) : read_kalibr_imu(file);
  }

 private:
  fs::path body_;
  fs::path kalibr_;  ///< empty: every sensor has a sensor.yaml
};

ImageFiles left_frame(const fs::path& camera, const ListedImage& image) {
  ImageFiles files;
  files.timestamp = image.timestamp;
  files.colour = camera / "data" / image.name;
  files.colour_listed_at = {(camera / "data.csv").string(), image.line};
  return files;
}

std::vector<ImageFiles> find_frames(const fs::path& body, bool is_pair, double max_time_difference) {
  std::vector<ImageFiles> frames;
  const fs::path left_camera = body / "cam0", right_camera = body / "cam1";
  const std::vector<ListedImage> left = read_euroc_image_list(left_camera / "data.csv");
  if (!is_pair) {
    for (const ListedImage& image : left) frames.push_back(left_frame(left_camera, image));
    return frames;
  }
  const std::vector<ListedImage> right = read_euroc_image_list(right_camera / "data.csv");
  for (const auto& [l, r] : associate_stamps(stamps_of(left), stamps_of(right), max_time_difference)) {
    ImageFiles& files = frames.emplace_back(left_frame(left_camera, left[l]));
    files.right = right_camera / "data" / right[r].name;
    files.right_listed_at = {(right_camera / "data.csv").string(), right[r].line};
  }
  if (frames.empty())
    throw InputError({(right_camera / "data.csv").string()},
                     "has no image within " + stamp_text(max_time_difference) +
                         " s of one of cam0; expected the images of a pair; set `cameras: left`, or raise "
                         "`max_time_difference`");
  return frames;
}

/// The poses of the body moved to a camera on it. The truth of TUM VI lies in mocap0.
Trajectory read_truth(const fs::path& body, const Eigen::Isometry3d& T_body_camera) {
  std::error_code error;
  for (const char* name : {"state_groundtruth_estimate0", "mocap0"}) {
    const fs::path folder = body / name;
    if (!fs::exists(folder / "data.csv", error)) continue;
    Eigen::Isometry3d T_body_tracked = Eigen::Isometry3d::Identity();
    if (fs::exists(folder / "sensor.yaml", error)) T_body_tracked = read_euroc_pose(folder / "sensor.yaml");
    const Eigen::Isometry3d T_tracked_camera = T_body_tracked.inverse() * T_body_camera;
    TrajectoryReading reading;
    reading.format = TrajectoryFormat::euroc;
    Trajectory truth = read_trajectory_file(folder / "data.csv", reading).poses;
    for (TimedPose& pose : truth) pose.T_world_camera = pose.T_world_camera * T_tracked_camera;
    return truth;
  }
  return {};
}

/// The inertial measurements, with their calibration for the camera of the frames. The IMU's own axes and origin are
/// the body frame of ImuCalibration; in the ASL layout they are usually those of the recording's body as well.
void add_imu(const fs::path& body, const EurocOptions& options, const AslCalibration& calibration,
             const Eigen::Isometry3d& T_body_camera, CalibratedRecording& recording) {
  std::error_code error;
  if (!options.with_imu || !fs::exists(body / "imu0" / "data.csv", error)) return;
  recording.imu_file = body / "imu0" / "data.csv";
  if (options.imu)
    recording.imu = options.imu;
  else if ((recording.imu = calibration.imu()))
    recording.imu->T_body_camera = recording.imu->T_body_camera * T_body_camera;
  if (recording.imu && recording.rectification)
    recording.imu->T_body_camera = recording.imu->T_body_camera * recording.rectification->T_left_rectified();
}

}  // namespace

CalibratedRecording read_euroc_recording(const EurocOptions& options) {
  const fs::path body = find_body(options);
  std::error_code error;
  const bool is_pair =
      options.cameras == "pair" || (options.cameras == "auto" && fs::is_directory(body / "cam1", error));
  CalibratedRecording recording;
  const AslCalibration calibration(body);
  const EurocCamera left = calibration.camera("cam0");
  recording.camera = left.camera;
  recording.left_size = recording.right_size = {left.camera.width, left.camera.height};
  Eigen::Isometry3d T_body_camera = left.T_body_camera;
  if (is_pair) {
    const EurocCamera right = calibration.camera("cam1");
    rectify_pair(recording, right.camera, left.T_body_camera.inverse() * right.T_body_camera,
                 calibration.file_of("cam1"));
    T_body_camera = T_body_camera * recording.rectification->T_left_rectified();
  }
  add_imu(body, options, calibration, left.T_body_camera, recording);
  recording.files = find_frames(body, is_pair, options.max_time_difference);
  if (!calibration.has_frame_rate()) measure_frame_rate(recording);
  recording.truth = read_truth(body, T_body_camera);
  recording.truth_frame = "transformed";
  select_range(recording.files, options.range.start, options.range.frames, options.path,
               is_pair ? "stereo pairs" : "frames");
  return recording;
}

}  // namespace holdfast
