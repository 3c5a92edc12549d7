// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "holdfast/image_files/phone_recording.hpp"

namespace holdfast {

/// The readers of the layouts, for read_phone_recording(): frames in temporal order, camera of the images in the files,
/// poses. They throw InputError.
CalibratedRecording read_record3d(const std::filesystem::path& folder, const PhoneOptions& options);
CalibratedRecording read_transforms(const std::filesystem::path& folder, const PhoneOptions& options);
CalibratedRecording read_stray_scanner(const std::filesystem::path& folder, const PhoneOptions& options);

/// Intrinsics of a frame [px] in the convention of all three layouts: the origin is the top left corner of the image,
/// so that the centre of the first pixel is at (0.5, 0.5). Apple documents it for ARCamera.intrinsics and, in more
/// words, for AVCameraCalibrationData.intrinsicMatrix, and Nerfstudio sends the ray of pixel (x, y) through (x + 0.5, y
/// + 0.5).
struct FrameIntrinsics {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;
};
/// Sets the intrinsics of a camera to the medians of those of the frames, at least one, with the origin in the centre
/// of the first pixel, half a pixel further.
void set_median_intrinsics(Camera& camera, const std::vector<FrameIntrinsics>& frames);

}  // namespace holdfast
