// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "holdfast/core/trajectory.hpp"
#include "holdfast/image_files/image_list.hpp"

namespace holdfast {

/// Reads associations.txt of a recording of ICL-NUIM (Handa et al., ICRA 2014) in its TUM-compatible form. Its lines
/// name the depth image first; the result has the colour image in ListedPair::colour, in either order of the file. The
/// stamps are the numbers of the frames. Throws as read_association_list().
std::vector<ListedPair> icl_nuim_pairs(const std::filesystem::path& folder);

/// The only file *.gt.freiburg of the folder. Throws InputError if there is none or more than one.
std::filesystem::path icl_nuim_truth_file(const std::filesystem::path& folder);

/// Reads true poses whose first number is that of the frame; the stamps of the result are number / frame_rate [s].
///
/// The published poses belong to a camera whose y axis points up (fy = -480), in a left-handed world, whereas the
/// TUM-compatible images have their first row at the top. Reflecting world and camera at y = 0 (S T S with S =
/// diag(1, -1, 1)) gives the poses of a camera with x to the right, y down, z forward and fy = 480, and rotations
/// remain rotations. Throws as read_trajectory().
Trajectory read_icl_nuim_truth(const std::filesystem::path& file, double frame_rate);

}  // namespace holdfast
