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

/// Formats a cloud as binary little-endian PLY with float x y z and uchar red green blue per vertex.
std::string cloud_ply(std::span<const CloudPoint> cloud);
/// Writes cloud_ply() to a file atomically. Throws InputError if it cannot be written.
void write_cloud_ply(const std::filesystem::path& file, std::span<const CloudPoint> cloud);

}  // namespace holdfast
