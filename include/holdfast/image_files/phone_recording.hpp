// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "holdfast/image_files/calibrated_recording.hpp"

namespace holdfast {

/// Layout of the folder that an app of a phone with a depth sensor exports.
enum class PhoneLayout {
  record3d,       ///< "EXR + RGB sequence" of Record3D: metadata.json, rgb/ and depth/*.exr in metres
  transforms,     ///< transforms.json of NeRFCapture and of Nerfstudio, with images and depth images that it names
  stray_scanner,  ///< Stray Scanner: odometry.csv, camera_matrix.csv, rgb.mp4, depth/, confidence/
};

/// The layout of a folder by its files, and the folder that holds them: `folder` or its EXR_RGBD. Throws InputError for
/// a folder of another kind, and for a file or folder .r3d of Record3D, whose depth no library of Debian decompresses.
struct PhoneFolder {
  PhoneLayout layout;
  std::filesystem::path folder;
};
PhoneFolder find_phone_folder(const std::filesystem::path& folder);
/// Whether find_phone_folder() finds a layout; never throws.
bool is_phone_folder(const std::filesystem::path& folder);

/// Options of read_phone_recording().
struct PhoneOptions {
  std::filesystem::path path;
  int width = 0;               ///< of the frames [px]; the height follows; 0 = as recorded
  double frame_rate = 30.0;    ///< of a recording without time stamps [1/s]
  double depth_factor = 0.0;   ///< value of one metre in depth images; 0 = as the recording says
  int minimum_confidence = 1;  ///< of depth, from 0 to 2; see ImageSequenceOptions::minimum_confidence
  FrameRange range;
};

/// Finds the frames of a recording of a phone, with the camera and, as its truth, the poses that the phone estimated.
/// The calibration is the median of those of the frames, because the focal length follows the autofocus. Depth images
/// are smaller than colour images of the same view and are scaled to them. Reads no images; where colour is a video
/// (CalibratedRecording::colour_is_video), its size is left 0, and resize_frames() completes the camera. Throws
/// InputError with the file and, where there is one, the line.
CalibratedRecording read_phone_recording(const PhoneOptions& options);

/// Sets the size of the colour images in the files, and the camera of frames of the given width (0 = as recorded).
/// Throws InputError at `place` for a width that is larger than that of the files.
void resize_frames(CalibratedRecording& recording, const cv::Size& size, int width, const std::string& place);

}  // namespace holdfast
