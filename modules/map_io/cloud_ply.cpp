// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/map_io/cloud_ply.hpp"

#include "bytes.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/core/version.hpp"

namespace holdfast {

std::string cloud_ply(std::span<const CloudPoint> cloud) {
  map_io::ByteWriter writer;
  writer.put_bytes("ply\nformat binary_little_endian 1.0\ncomment static scene [m], made by Holdfast " HOLDFAST_VERSION
                   "\nelement vertex " +
                   std::to_string(cloud.size()) +
                   "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
                   "property uchar blue\nend_header\n");
  for (const CloudPoint& point : cloud) {
    for (const float value : {point.x, point.y, point.z}) writer.put(value);
    for (const std::uint8_t value : {point.red, point.green, point.blue}) writer.put(value);
  }
  return writer.bytes();
}

void write_cloud_ply(const std::filesystem::path& file, std::span<const CloudPoint> cloud) {
  write_file_atomically(file, cloud_ply(cloud));
}

}  // namespace holdfast
