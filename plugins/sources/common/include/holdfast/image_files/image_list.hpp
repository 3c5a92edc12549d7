// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace holdfast {

/// A line of a list of images.
struct ListedImage {
  double timestamp = 0.0;  ///< [s]
  std::string name;        ///< as it stands in the list
  int line = 0;            ///< from 1
};

/// A line of an association file.
struct ListedPair {
  ListedImage colour;
  ListedImage depth;
};

/// Reads a list in TUM format: lines "timestamp filename", '#' begins a comment line, stamps rise strictly. Throws
/// InputError (file and line) for a missing or empty list, a line of another form, a stamp that is not finite, not
/// later than the one before, or the same.
std::vector<ListedImage> read_image_list(const std::filesystem::path& file);

/// Reads an association file: lines "colour_timestamp colour_file depth_timestamp depth_file". As read_image_list; the
/// colour stamps rise strictly, and the depth stamps are only kept.
std::vector<ListedPair> read_association_list(const std::filesystem::path& file);

/// Reads stamps, one per line. As read_image_list; the names stay empty.
std::vector<ListedImage> read_stamp_list(const std::filesystem::path& file);

/// A stamp as the lists write it, with 6 decimals.
std::string stamp_text(double timestamp);

}  // namespace holdfast
