// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "holdfast/core/map.hpp"

/// Map files (.hfm): a header and sections, little-endian, each with a checksum (CRC-32C), so that damage is always
/// detected. docs/map_format.md defines the layout. A file contains the complete content of Map except the poses of
/// removed keyframes (which serve the trajectory of the run that removed them) and Map::version(). The index for place
/// recognition is not part of a map; after loading, the static descriptors of the keyframes must be added to a
/// detector.
///
/// Ids are not stored. Reading assigns new ones: keyframes 0, 1, 2, ... by increasing sequence, points in slot order.
/// Writing a map that was read therefore gives the same bytes, and a run that continues a map is deterministic.
///
/// Errors are InputError that states the file, what was found, what was expected and how to correct it.
namespace holdfast {

/// Writes the map, or one of its submaps, atomically: an existing file remains unchanged if writing fails. The map must
/// not be modified meanwhile (hold its lock). Throws InputError if the file cannot be written, CheckError if the map
/// violates an invariant of Map or contains a number that is not finite.
void write_map(const std::filesystem::path& file, const Map& map, std::optional<std::uint32_t> submap = std::nullopt);

/// Replaces the content of `map`; the map remains unchanged if an error is thrown. Throws InputError for a file that is
/// missing, empty, of another type, truncated, damaged, of a newer format, or inconsistent.
void read_map(const std::filesystem::path& file, Map& map);
Map read_map(const std::filesystem::path& file);

}  // namespace holdfast
