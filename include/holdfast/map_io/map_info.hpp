// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/map_features.hpp"
#include "holdfast/core/map_inertia.hpp"
#include "holdfast/core/sensor.hpp"

namespace holdfast {

/// Key figures of a map file.
struct MapInfo {
  std::string file;
  std::uint64_t file_size = 0;  ///< [bytes]
  std::uint32_t format_version = 0;
  std::string made_by;  ///< version of Holdfast that wrote the file
  Sensor sensor = Sensor::rgbd;
  MapFeatures map_features;
  std::vector<Camera> cameras;
  std::uint64_t keyframes = 0;
  std::uint64_t features = 0;
  std::uint64_t points = 0;
  std::uint64_t observations = 0;
  std::vector<std::pair<std::string, std::uint64_t>> classes;  ///< name and number of points, by label
  std::optional<MapInertia> inertia;
  std::uint64_t motions = 0;             ///< keyframes with a velocity (KeyFrame::motion)
  std::uint64_t covisibility_edges = 0;  ///< each pair once
  std::uint64_t loops = 0;               ///< each pair once
  std::uint64_t next_sequence = 0;
  double first_timestamp = 0.0, last_timestamp = 0.0;       ///< of the keyframes [s]; 0 without keyframes
  Eigen::Vector3d minimum_point = Eigen::Vector3d::Zero();  ///< corner of the bounding box of all points, world [m]
  Eigen::Vector3d maximum_point = Eigen::Vector3d::Zero();
};

/// Reads a map file section by section and verifies every checksum, but does not store features, so that it takes a
/// fraction of the memory of read_map(). The consistency of references is not checked. Throws InputError as read_map().
MapInfo read_map_info(const std::filesystem::path& file);

/// Formats as a table for a terminal, and as one JSON object with the members of MapInfo.
std::string to_text(const MapInfo& info);
std::string to_json(const MapInfo& info);

}  // namespace holdfast
