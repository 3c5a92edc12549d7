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

/// A recording that contains the calibration of its camera.
struct CalibratedRecording {
  std::vector<ImageFiles> files;   ///< of every frame, in temporal order
  Camera camera;                   ///< camera of the frames delivered by a source, after rectification
  cv::Size left_size, right_size;  ///< sizes of the images in the files; equal without a pair
  bool has_right = false;
  std::optional<DepthEncoding> depth;                        ///< encoding of the depth images; empty without depth
  std::string invalid_depth_key;                             ///< see ImageSequenceOptions
  bool has_global_shutter = true;                            ///< as for the cameras of KITTI, EuRoC and fisheye pairs
  std::shared_ptr<const StereoRectification> rectification;  ///< nullptr = the images are rectified already
  Trajectory truth;                                          ///< of `camera`; empty if there is none
  std::string truth_frame = "raw";                           ///< see SourceDescription
  std::filesystem::path imu_file;                            ///< of inertial measurements; empty without any
  std::optional<ImuCalibration> imu;                         ///< relative to `camera`
  bool colour_is_video = false;                              ///< ImageFiles::colour is one, and video_index is set
  bool scales_depth = false;                                 ///< see ImageSequenceOptions, as the next two
  int minimum_confidence = 0;
  ImageReaders readers;
};

/// Converts a recording of the left camera into one of a stereo pair with rectification. `T_left_right` maps points of
/// the right camera to the left one. Throws InputError that names `file`, which has the calibration, for cameras that
/// cannot be rectified.
void rectify_pair(CalibratedRecording& recording, const Camera& right, const Eigen::Isometry3d& T_left_right,
                  const std::filesystem::path& file);

/// Sets the frame rate of the camera to the mean rate of the frames, if there are two.
void measure_frame_rate(CalibratedRecording& recording);

/// Range of the frames of a recording to read.
struct FrameRange {
  std::int64_t start = 0;   ///< index of the first frame
  std::int64_t frames = 0;  ///< number of frames; 0 = all
};

/// Options of read_kitti_recording().
struct KittiOptions {
  std::filesystem::path path;  ///< folder of the sequence
  /// colour: image_2 and image_3; grey: image_0 and image_1; pair: left and right; auto: the first of these that
  /// exists, or the first left camera if there is no pair.
  std::string cameras = "auto";
  std::filesystem::path poses;  ///< file of the true poses; empty = the usual file of the data set, if it exists
  double frame_rate = 10.0;     ///< without times.txt [1/s]
  FrameRange range;
  bool left_is_enough = false;  ///< for named cameras: use the left camera alone if the right one is missing
};

/// Finds the frames of a sequence in the layout of the KITTI odometry data (Geiger et al. 2012), or of a synchronised
/// and rectified drive of the raw data (Geiger et al. 2013), with camera and truth. Reads only the size of the first
/// image. Throws InputError.
CalibratedRecording read_kitti_recording(const KittiOptions& options);

/// Options of read_euroc_recording().
struct EurocOptions {
  std::filesystem::path path;          ///< folder of the sequence, which contains mav0, or mav0 itself
  std::string cameras = "auto";        ///< pair: cam0 and cam1; left: cam0; auto: pair if cam1 exists
  double max_time_difference = 0.002;  ///< upper bound of the time between the images of a pair [s]
  FrameRange range;
  bool with_imu = true;               ///< read imu0 if it exists
  std::optional<ImuCalibration> imu;  ///< replaces the calibration of the recording; relative to the unrectified cam0
};

/// Finds the frames of a sequence in the ASL layout of the EuRoC MAV data (Burri et al. 2016), with camera and truth.
/// The calibration is that of each sensor's sensor.yaml or, as in TUM VI (Schubert et al. 2018), in dso/ beside mav0.
/// Images without a counterpart within max_time_difference are ignored. Reads no images. Throws InputError.
CalibratedRecording read_euroc_recording(const EurocOptions& options);

/// Options of read_openloris_recording().
struct OpenLorisOptions {
  std::filesystem::path path;  ///< folder of the sequence, with sensors.yaml
  /// rgbd: color and aligned_depth of the D435i; stereo: fisheye1 and fisheye2 of the T265; left: fisheye1 alone.
  std::string cameras = "rgbd";
  double max_time_difference = 0.02;  ///< upper bound of the time between the two images of a frame [s]
  DepthEncoding depth = {1000.0};
  bool colour_is_enough = false;  ///< use colour images alone if aligned_depth.txt is missing
  FrameRange range;
};

/// Finds the frames of a sequence in the package format of OpenLORIS-Scene (Shi et al., ICRA 2020), with camera and
/// truth: the recorded poses of base_link, moved to the camera by trans_matrix.yaml. Images without a counterpart
/// within max_time_difference are ignored. Reads no images. Throws InputError.
CalibratedRecording read_openloris_recording(const OpenLorisOptions& options);

/// Options of read_four_seasons_recording().
struct FourSeasonsOptions {
  std::filesystem::path path;         ///< folder of the sequence, with times.txt and undistorted_images
  std::string cameras = "auto";       ///< pair: cam0 and cam1; left: cam0; auto: pair if cam1 exists
  std::filesystem::path calibration;  ///< folder of the calibration; empty = in the folder of the sequence or beside it
  FrameRange range;
  std::optional<ImuCalibration> imu;  ///< of imu.txt, which is read if this is given
};

/// Finds the undistorted frames of a sequence of 4Seasons (Wenzel et al., GCPR 2020), with camera and truth: the poses
/// of keyframes in GNSSPoses.txt. Reads no images. Throws InputError.
CalibratedRecording read_four_seasons_recording(const FourSeasonsOptions& options);

/// Source of the frames of a CalibratedRecording; grey images are converted to three equal channels.
class CalibratedSource : public ImageSequenceSource {
 public:
  CalibratedSource(CalibratedRecording recording, const std::filesystem::path& folder, bool skip_bad_frames);
};

}  // namespace holdfast
