// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>

#include "holdfast/core/camera.hpp"
#include "holdfast/image_files/stereo_rectification.hpp"

namespace holdfast {

/// A camera and, for a stereo pair to be rectified, its right camera.
struct CameraFile {
  Camera camera;
  std::optional<StereoCameras> pair;  ///< its left camera is `camera`
};

/// Reads a camera from a YAML or JSON file: fx, fy, cx, cy, width and height are required; k1 to k6, p1, p2 and lens
/// (see Distortion), baseline [m] and name are optional; Missing values are those of `defaults`, except for the
/// distortion (zero) and the name (that of the file). `right` is a map of the same keys without baseline for the right
/// camera of a pair that is not rectified, and of T_left_right, the 16 numbers of a 4 x 4 matrix or its four rows,
/// which maps points from the frame of the right camera to that of the left one [m]. `setting` names the file in
/// messages. Throws InputError (file, line and column) for missing, unknown or duplicate keys and for invalid values.
CameraFile read_camera_file(const std::filesystem::path& file, const Camera& defaults, const std::string& setting);

}  // namespace holdfast
