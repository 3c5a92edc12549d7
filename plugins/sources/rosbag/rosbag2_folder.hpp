// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

namespace holdfast::rosbag_plugin {

/// The files of a recording in their order.
struct Rosbag2Files {
  std::vector<std::filesystem::path> files;
  bool has_metadata = false;
};

/// The files of a folder of rosbag2: those that its metadata.yaml lists; without one, all files .db3, .mcap, and these
/// with .zstd, of one name, by their numbers. Throws InputError for a damaged metadata.yaml, for a file that is
/// missing, for a compression that is not zstd, and for a folder of several recordings or none.
Rosbag2Files find_rosbag2_files(const std::filesystem::path& folder);

}  // namespace holdfast::rosbag_plugin
