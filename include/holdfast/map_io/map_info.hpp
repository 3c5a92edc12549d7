// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/core/camera.hpp"

namespace holdfast {

/// What a map file holds, in figures.
struct MapInfo {
  std::string file;
  std::uint64_t file_size = 0;  ///< [bytes]
  std::uint32_t format_version = 0;
  std::string made_by;  ///< version of the Holdfast that wrote it
  std::vector<Camera> cameras;
  std::uint64_t keyframes = 0;
  std::uint64_t features = 0;
  std::uint64_t points = 0;
  std::uint64_t observations = 0;
  std::uint64_t covisibility_edges = 0;  ///< each pair once
  std::uint64_t loops = 0;               ///< each pair once
  std::uint64_t next_sequence = 0;
  double first_timestamp = 0.0, last_timestamp = 0.0;       ///< of the keyframes [s]; 0 without any
  Eigen::Vector3d minimum_point = Eigen::Vector3d::Zero();  ///< corner of the box around all points, world [m]
  Eigen::Vector3d maximum_point = Eigen::Vector3d::Zero();
};

/// Reads a map file section by section and verifies every checksum, but keeps no features: a fraction of the memory
/// that read_map() takes. Whether references agree is not checked. Throws InputError as read_map() does.
MapInfo read_map_info(const std::filesystem::path& file);

/// A table for people, and one JSON object with the members of MapInfo.
std::string to_text(const MapInfo& info);
std::string to_json(const MapInfo& info);

}  // namespace holdfast
