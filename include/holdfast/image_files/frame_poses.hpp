// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "holdfast/core/trajectory.hpp"
#include "holdfast/image_files/numbered_files.hpp"

namespace holdfast {

/// A frame of a recording of numbered images, to which files of poses refer.
struct NumberedFrame {
  double timestamp = 0.0;  ///< [s]
  std::size_t index = 0;   ///< of the image among all images of the recording
  FileNumbers numbers;     ///< of the image's file name
};

/// Reads the true poses T_world_camera of frames, in metres, from a file or folder in any of these layouts:
///
/// - lines of 8 numbers: a trajectory in TUM format, see read_trajectory(); the stamps are its own;
/// - lines of 16 or 12 numbers: a 4 x 4 or 3 x 4 matrix for each image, row by row (Replica, KITTI);
/// - a folder of text files with the numbers of the images, or a pattern such as "frame-%06d.pose.txt", each with the
///   four or three rows of such a matrix (ScanNet, 7-Scenes);
/// - an array of NumPy (.npy) of float32 or float64: n x 4 x 4, n x 3 x 4, n x 16 or n x 12;
/// - JSON with "frames", each with "transform_matrix" and perhaps "file_path" (Nerfstudio, instant-ngp), or with
/// "poses"
///   of seven numbers qx qy qz qw px py pz (Record3D): of cameras that look along -z with y up, as OpenGL has them,
///   which are converted.
///
/// `image_count` is the number of all images; poses without numbers must have one for each image. Poses that are not
/// finite (ScanNet's mark of a missing pose) are omitted. Throws InputError (with the line, if there is one) for
/// anything else, such as a scaled or mirrored matrix.
Trajectory read_frame_poses(const std::filesystem::path& path, const std::vector<NumberedFrame>& frames,
                            std::size_t image_count);

}  // namespace holdfast
