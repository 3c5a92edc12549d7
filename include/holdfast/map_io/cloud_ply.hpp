// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "holdfast/core/cloud_point.hpp"

namespace holdfast {

/// Formats a cloud as binary little-endian PLY with float x y z and uchar red green blue per vertex.
std::string cloud_ply(std::span<const CloudPoint> cloud);
/// Writes cloud_ply() to a file atomically. Throws InputError if it cannot be written.
void write_cloud_ply(const std::filesystem::path& file, std::span<const CloudPoint> cloud);

/// Reads a file of write_cloud_ply(), in world coordinates [m]; std::nullopt for a PLY file whose vertices have other
/// properties, such as the points of a map. Throws InputError for a file that cannot be read, is no PLY file, differs
/// in length from its header, or contains a position that is not finite.
std::optional<std::vector<CloudPoint>> read_cloud_ply(const std::filesystem::path& file);

}  // namespace holdfast
