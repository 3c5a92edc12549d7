// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace holdfast::precomputed_plugin {

/// The labels of a moment.
struct LabelFile {
  double timestamp = 0.0;                          ///< [s]
  std::filesystem::path path;                      ///< of the label image, or of the first instance
  bool is_of_instance = false;                     ///< each file is the mask of one instance
  std::vector<std::filesystem::path> others = {};  ///< of the other instances
};

/// The time stamp that a name without ending is, such as 1305031102.175304; nothing if it is none.
std::optional<double> stamp_of(const std::string& name);

/// Whether the file is an array of NumPy (.npy, .npz) rather than a PNG.
bool is_array(const std::filesystem::path& file);

/// The PNG and NPY files of a folder by the time stamps that their names are (1305031102.175304.png), sorted, and those
/// of instances, with anything behind an underscore (1305031102.175304_2.png), in the order of their names; other files
/// are left alone. Throws InputError for a folder that is missing or holds none, a name that is no stamp, and two files
/// of the same stamp that are not of instances.
std::vector<LabelFile> find_label_files(const std::filesystem::path& folder);

/// Those that a list names, lines "timestamp filename", names relative to the folder. Throws as read_image_list().
std::vector<LabelFile> listed_label_files(const std::filesystem::path& folder, const std::filesystem::path& list);

/// The file nearest in time, at most `tolerance` seconds away; nullptr when there is none. Of two equally near ones the
/// earlier.
const LabelFile* nearest_label_file(const std::vector<LabelFile>& files, double timestamp, double tolerance);

}  // namespace holdfast::precomputed_plugin
