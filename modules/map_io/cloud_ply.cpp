// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/map_io/cloud_ply.hpp"

#include <cmath>

#include "bytes.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/core/parsed_number.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/core/version.hpp"

namespace holdfast {

namespace {

constexpr std::string_view cloud_properties =
    "property float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
    "property uchar blue\n";
constexpr std::string_view binary_format = "ply\nformat binary_little_endian 1.0\n", header_end = "end_header\n";
constexpr std::size_t bytes_per_point = 3 * sizeof(float) + 3;

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& reason) {
  throw InputError({file.string()}, reason + "; expected a cloud as a run has written it, run it again");
}

}  // namespace

std::string cloud_ply(std::span<const CloudPoint> cloud) {
  ByteWriter writer;
  writer.put_bytes(binary_format);
  writer.put_bytes("comment static scene [m], made by Holdfast " HOLDFAST_VERSION "\nelement vertex " +
                   std::to_string(cloud.size()) + "\n");
  writer.put_bytes(cloud_properties);
  writer.put_bytes(header_end);
  for (const CloudPoint& point : cloud) {
    for (const float value : {point.x, point.y, point.z}) writer.put(value);
    for (const std::uint8_t value : {point.red, point.green, point.blue}) writer.put(value);
  }
  return writer.bytes();
}

void write_cloud_ply(const std::filesystem::path& file, std::span<const CloudPoint> cloud) {
  write_file_atomically(file, cloud_ply(cloud));
}

std::optional<std::vector<CloudPoint>> read_cloud_ply(const std::filesystem::path& file) {
  const std::string bytes = file_content(file, largest_file::cloud, "a cloud as a run has written it");
  const std::string_view text(bytes);
  if (!text.starts_with("ply\n")) refuse(file, "is no PLY file");
  const std::size_t end = text.find(header_end);
  if (end == std::string_view::npos) refuse(file, "its header has no end");
  const std::string_view header = text.substr(0, end);
  constexpr std::string_view vertices = "\nelement vertex ";
  const std::size_t element = header.find(vertices);
  if (!header.starts_with(binary_format) || element == std::string_view::npos) return std::nullopt;
  const std::string_view rest = header.substr(element + vertices.size());
  const std::string_view number = rest.substr(0, rest.find('\n'));
  if (rest.size() <= number.size() || rest.substr(number.size() + 1) != cloud_properties) return std::nullopt;
  const auto count = parsed_number<std::size_t>(number);
  const std::string_view data = text.substr(end + header_end.size());
  if (!count || *count != data.size() / bytes_per_point || data.size() % bytes_per_point != 0)
    refuse(file, "states " + std::string(number) + " points and has " + std::to_string(data.size()) + " bytes of them");
  map_io::ByteReader reader(data, file.string(), "points", end + header_end.size());
  std::vector<CloudPoint> cloud(*count);
  for (CloudPoint& point : cloud) {
    for (float* value : {&point.x, &point.y, &point.z}) {
      *value = reader.get<float>();
      if (!std::isfinite(*value)) refuse(file, "contains a position that is not finite");
    }
    for (std::uint8_t* value : {&point.red, &point.green, &point.blue}) *value = reader.get<std::uint8_t>();
  }
  return cloud;
}

}  // namespace holdfast
