// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace holdfast {

/// A point of a dense cloud.
struct CloudPoint {
  float x = 0, y = 0, z = 0;  ///< world [m]
  std::uint8_t red = 0, green = 0, blue = 0;

  friend bool operator==(const CloudPoint&, const CloudPoint&) = default;
};

/// Binary little-endian PLY: float x y z, uchar red green blue per vertex, as viewers of point clouds expect it.
std::string cloud_ply(std::span<const CloudPoint> cloud);
/// The same into a file, in one step. Throws InputError when it cannot be written.
void write_cloud_ply(const std::filesystem::path& file, std::span<const CloudPoint> cloud);

}  // namespace holdfast
