// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "holdfast/core/map.hpp"

/// Map files (.hfm): a header and sections, little-endian, each under its own checksum (CRC-32C), so that no damage
/// goes unseen. docs/map_format.md has the layout, byte by byte. A file holds everything that Map holds, with these
/// exceptions: poses of removed keyframes (they serve the trajectory of the run that removed them) and Map::version().
/// The index for place recognition is no part of a map; whoever loads one adds its keyframes to a detector.
///
/// Ids are not stored. Reading gives new ones: keyframes 0, 1, 2, ... by rising sequence, points in slot order. Writing
/// what was read therefore gives the same bytes, and a run that continues a map is deterministic.
///
/// Errors are InputError and name the file, what was found, what was expected and what to do.
namespace holdfast {

/// Writes beside the file first and then takes its place: a file that was there stays whole when writing fails. The map
/// must not change meanwhile (hold its lock). Throws InputError when the file cannot be written, CheckError when the
/// map breaks what Map promises or holds a number that is not finite.
void write_map(const std::filesystem::path& file, const Map& map);

/// Replaces the content of `map`, which stays as it was when an error is thrown. Never changes the file. Throws
/// InputError for a file that is missing, empty, foreign, cut off, damaged, of a newer format, or inconsistent.
void read_map(const std::filesystem::path& file, Map& map);
Map read_map(const std::filesystem::path& file);

}  // namespace holdfast
