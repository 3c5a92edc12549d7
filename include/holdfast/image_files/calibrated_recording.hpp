// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/imu.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/image_files/image_sequence.hpp"
#include "holdfast/image_files/stereo_rectification.hpp"

namespace holdfast {

/// A recording whose own files give its camera.
struct CalibratedRecording {
  std::vector<ImageFiles> files;   ///< of every frame, in temporal order
  Camera camera;                   ///< of the frames as a source gives them: rectified where that is needed
  cv::Size left_size, right_size;  ///< of the images in the files; the latter is that of the former without a pair
  bool has_right = false;
  std::optional<DepthEncoding> depth;  ///< of the depth images; nothing for a recording without
  std::string invalid_depth_key;       ///< see ImageSequenceOptions
  bool has_global_shutter = true;      ///< as the cameras of KITTI, EuRoC and fisheye pairs have it
  std::shared_ptr<const StereoRectification> rectification;  ///< nullptr: the images need none
  Trajectory truth;                                          ///< of `camera`; empty if there is none
  std::string truth_frame = "raw";                           ///< see SourceDescription
  std::filesystem::path imu_file;                            ///< of inertial measurements; empty without any
  std::optional<ImuCalibration> imu;                         ///< relative to `camera`
};

/// Makes a recording of one camera, the left one, that of a pair which has to be rectified. `T_left_right` maps points
/// of the right camera to the left one. Throws InputError that names `file`, which has the calibration, for cameras
/// that cannot be rectified.
void rectify_pair(CalibratedRecording& recording, const Camera& right, const Eigen::Isometry3d& T_left_right,
                  const std::filesystem::path& file);

/// Which frames of a recording are read.
struct FrameRange {
  std::int64_t start = 0;   ///< index of the first frame
  std::int64_t frames = 0;  ///< their number; 0 = all
};

/// What read_kitti_recording() is told.
struct KittiOptions {
  std::filesystem::path path;  ///< folder of the sequence
  /// colour: image_2 and image_3; grey: image_0 and image_1; pair: left and right; auto: the first of these that
  /// exists, or the first left camera if there is no pair.
  std::string cameras = "auto";
  std::filesystem::path poses;  ///< truth; empty: where the data set has it, if anywhere
  double frame_rate = 10.0;     ///< without times.txt [1/s]
  FrameRange range;
  bool left_is_enough =
      false;  ///< of named cameras: the left one alone will do if the folder of the right one is missing
};

/// Finds the frames of a sequence in the layout of the KITTI odometry data (Geiger et al. 2012), with camera and truth.
/// Reads no image but the size of the first. Throws InputError.
CalibratedRecording read_kitti_recording(const KittiOptions& options);

/// What read_euroc_recording() is told.
struct EurocOptions {
  std::filesystem::path path;          ///< folder of the sequence, which contains mav0, or mav0 itself
  std::string cameras = "auto";        ///< pair: cam0 and cam1; left: cam0; auto: pair if cam1 exists
  double max_time_difference = 0.002;  ///< upper bound of the time between the images of a pair [s]
  FrameRange range;
  bool with_imu = true;               ///< read imu0 if it exists
  std::optional<ImuCalibration> imu;  ///< in place of the calibration of the recording; relative to cam0 as it is
};

/// Finds the frames of a sequence in the ASL layout of the EuRoC MAV data (Burri et al. 2016), with camera and truth.
/// An image without one of the other camera near enough in time makes no frame. Reads no image. Throws InputError.
CalibratedRecording read_euroc_recording(const EurocOptions& options);

/// What read_openloris_recording() is told.
struct OpenLorisOptions {
  std::filesystem::path path;  ///< folder of the sequence, with sensors.yaml
  /// rgbd: color and aligned_depth of the D435i; stereo: fisheye1 and fisheye2 of the T265; left: fisheye1 alone.
  std::string cameras = "rgbd";
  double max_time_difference = 0.02;  ///< upper bound of the time between the two images of a frame [s]
  DepthEncoding depth = {1000.0};
  bool colour_is_enough = false;  ///< without aligned_depth.txt, the colour images alone will do
  FrameRange range;
};

/// Finds the frames of a sequence in the package format of OpenLORIS-Scene (Shi et al., ICRA 2020), with camera and
/// truth: the recorded poses of base_link, moved to the camera by trans_matrix.yaml. An image without a partner near
/// enough in time makes no frame. Reads no image. Throws InputError.
CalibratedRecording read_openloris_recording(const OpenLorisOptions& options);

/// The frames of a CalibratedRecording; grey images are widened to three equal channels.
class CalibratedSource : public ImageSequenceSource {
 public:
  CalibratedSource(CalibratedRecording recording, const std::filesystem::path& folder, bool skip_bad_frames);
};

}  // namespace holdfast
