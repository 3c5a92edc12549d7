// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace holdfast {

/// A line of a list of images.
struct ListedImage {
  double timestamp = 0.0;  ///< [s]
  std::string name;        ///< file name as listed
  int line = 0;            ///< from 1
};

/// A line of an association file.
struct ListedPair {
  ListedImage colour;
  ListedImage depth;
};

/// Reads a list in TUM format: lines "timestamp filename", '#' begins a comment line, time stamps increase strictly.
/// Throws InputError (file and line) for a missing or empty list, a malformed line, and a time stamp that is not finite
/// or not greater than the previous one.
std::vector<ListedImage> read_image_list(const std::filesystem::path& file);

/// Reads an association file: lines "colour_timestamp colour_file depth_timestamp depth_file". As read_image_list; the
/// colour stamps must increase strictly, the depth stamps are not checked.
std::vector<ListedPair> read_association_list(const std::filesystem::path& file);

/// Reads time stamps, one per line, as read_image_list; the names are empty.
std::vector<ListedImage> read_stamp_list(const std::filesystem::path& file);

/// Formats a time stamp with 6 decimals, as in lists.
std::string stamp_text(double timestamp);

}  // namespace holdfast
