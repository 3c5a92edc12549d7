// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "holdfast/core/map.hpp"
#include "holdfast/core/trajectory.hpp"

/// A map in formats that other programs read. In all of them keyframes are numbered 0, 1, 2, ... by rising sequence and
/// points in slot order, as in a map file.
namespace holdfast {

/// All points as binary little-endian PLY. Per vertex: x y z (world [m]), nx ny nz (unit mean direction towards the
/// cameras that saw it), `observations` (int) and `static_log_odds` (float, 0 = unknown).
std::string points_ply(const Map& map);
/// The same into a file, in one step. Throws InputError when it cannot be written.
void write_points_ply(const std::filesystem::path& file, const Map& map);

/// Poses of the keyframes by time stamp; equal stamps by sequence.
Trajectory keyframe_trajectory(const Map& map);

/// One JSON object: cameras, keyframes, covisibility edges, loops, points with observations; docs/map_format.md names
/// every member. Descriptors and features that show no point are left out.
std::string map_json(const Map& map);

}  // namespace holdfast
