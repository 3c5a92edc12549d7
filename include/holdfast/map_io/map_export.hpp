// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "holdfast/core/map.hpp"
#include "holdfast/core/trajectory.hpp"

/// Export of a map to formats of other programs. In all of them keyframes are numbered 0, 1, 2, ... by increasing
/// sequence and points in slot order, as in a map file.
namespace holdfast {

/// Formats all points as binary little-endian PLY. Per vertex: x y z (world [m]), nx ny nz (mean direction towards the
/// observing cameras, unit), `observations` (int) and `static_log_odds` (float, 0 = unknown).
std::string points_ply(const Map& map);
/// Writes the PLY to a file atomically. Throws InputError if it cannot be written.
void write_points_ply(const std::filesystem::path& file, const Map& map);

/// Poses of the keyframes by time stamp; equal stamps by sequence.
Trajectory keyframe_trajectory(const Map& map);

/// Formats the map as one JSON object: cameras, keyframes, covisibility edges, loops, points with observations;
/// docs/map_format.md defines every member. Descriptors, and features without a map point, are omitted.
std::string map_json(const Map& map);

}  // namespace holdfast
