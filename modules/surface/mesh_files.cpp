// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/mesh_files.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "holdfast/core/error.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/core/version.hpp"

namespace holdfast {

namespace {

template <class T>
void put(std::string& bytes, T value) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

void put(std::string& bytes, const Eigen::Vector3f& vector) {
  for (int i = 0; i < 3; ++i) put(bytes, vector[i]);
}

/// sRGB to linear, 16 bits (IEC 61966-2-1).
std::uint16_t linear(std::uint8_t value) {
  static const auto table = [] {
    std::array<std::uint16_t, 256> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double s = static_cast<double>(i) / 255.0;
      const double l = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
      values[i] = static_cast<std::uint16_t>(std::lround(65535.0 * l));
    }
    return values;
  }();
  return table[value];
}

std::string in_one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
  return text;
}

/// A chunk of a GLB file: padded to four bytes.
void put_chunk(std::string& bytes, std::uint32_t type, std::string content, char padding) {
  while (content.size() % 4 != 0) content += padding;
  put(bytes, static_cast<std::uint32_t>(content.size()));
  put(bytes, type);
  bytes += content;
}

nlohmann::json gltf_description(const TriangleMesh& mesh, std::size_t vertex_bytes, std::size_t index_bytes) {
  Eigen::AlignedBox3f box;
  for (const MeshVertex& vertex : mesh.vertices) box.extend(vertex.position);
  const auto corner = [](const Eigen::Vector3f& c) { return nlohmann::json{c.x(), c.y(), c.z()}; };
  constexpr int as_float = 5126, as_uint16 = 5123, as_uint32 = 5125, array_buffer = 34962, index_buffer = 34963;
  nlohmann::json description = {
      {"asset", {{"version", "2.0"}, {"generator", "Holdfast " HOLDFAST_VERSION}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      // World coordinates are those of a camera, y down; glTF has y up: half a turn about x.
      {"nodes", {{{"mesh", 0}, {"name", "surface"}, {"rotation", {1, 0, 0, 0}}}}},
      {"materials",
       {{{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}}, {"doubleSided", true}}}},
      {"meshes",
       {{{"primitives",
          {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"COLOR_0", 2}}}, {"indices", 3}, {"material", 0}}}}}}},
      {"buffers", {{{"byteLength", vertex_bytes + index_bytes}}}}};
  description["bufferViews"] = {
      {{"buffer", 0}, {"byteLength", vertex_bytes}, {"byteStride", 32}, {"target", array_buffer}},
      {{"buffer", 0}, {"byteOffset", vertex_bytes}, {"byteLength", index_bytes}, {"target", index_buffer}}};
  const std::size_t vertices = mesh.vertices.size();
  description["accessors"] = {
      {{"bufferView", 0},
       {"componentType", as_float},
       {"count", vertices},
       {"type", "VEC3"},
       {"min", corner(box.min())},
       {"max", corner(box.max())}},
      {{"bufferView", 0}, {"byteOffset", 12}, {"componentType", as_float}, {"count", vertices}, {"type", "VEC3"}},
      {{"bufferView", 0},
       {"byteOffset", 24},
       {"componentType", as_uint16},
       {"normalized", true},
       {"count", vertices},
       {"type", "VEC4"}},
      {{"bufferView", 1}, {"componentType", as_uint32}, {"count", 3 * mesh.triangles.size()}, {"type", "SCALAR"}}};
  return description;
}

}  // namespace

const std::vector<std::string>& mesh_formats() {
  static const std::vector<std::string> formats = {"ply", "obj", "glb"};
  return formats;
}

std::string mesh_ply(const TriangleMesh& mesh) {
  const bool has_classes = !mesh.classes.empty();
  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment surface [m], made by Holdfast " HOLDFAST_VERSION;
  for (std::size_t i = 0; i < mesh.classes.size(); ++i)
    bytes += "\ncomment label " + std::to_string(i) + " " + in_one_line(mesh.classes[i]);
  bytes += "\nelement vertex " + std::to_string(mesh.vertices.size());
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) bytes += std::string("\nproperty float ") + name;
  for (const char* name : {"red", "green", "blue"}) bytes += std::string("\nproperty uchar ") + name;
  if (has_classes) bytes += "\nproperty uchar label";
  bytes += "\nelement face " + std::to_string(mesh.triangles.size()) +
           "\nproperty list uchar int vertex_indices\nend_header\n";
  bytes.reserve(bytes.size() + 27 * mesh.vertices.size() + 13 * mesh.triangles.size());
  for (const MeshVertex& vertex : mesh.vertices) {
    put(bytes, vertex.position);
    put(bytes, vertex.normal);
    for (const std::uint8_t value : {vertex.red, vertex.green, vertex.blue}) put(bytes, value);
    if (has_classes) put(bytes, vertex.label);
  }
  for (const auto& triangle : mesh.triangles) {
    put(bytes, std::uint8_t{3});
    for (const std::uint32_t corner : triangle) put(bytes, corner);
  }
  return bytes;
}

std::string mesh_obj(const TriangleMesh& mesh) {
  std::string text = "# surface [m], made by Holdfast " HOLDFAST_VERSION "\n";
  std::array<char, 160> line{};
  const auto add = [&](int length) { text.append(line.data(), static_cast<std::size_t>(length)); };
  for (const MeshVertex& v : mesh.vertices)
    add(std::snprintf(line.data(), line.size(), "v %.5f %.5f %.5f %.4f %.4f %.4f\n",
                      static_cast<double>(v.position.x()), static_cast<double>(v.position.y()),
                      static_cast<double>(v.position.z()), v.red / 255.0, v.green / 255.0, v.blue / 255.0));
  for (const MeshVertex& v : mesh.vertices)
    add(std::snprintf(line.data(), line.size(), "vn %.4f %.4f %.4f\n", static_cast<double>(v.normal.x()),
                      static_cast<double>(v.normal.y()), static_cast<double>(v.normal.z())));
  for (const auto& t : mesh.triangles)
    add(std::snprintf(line.data(), line.size(), "f %u//%u %u//%u %u//%u\n", t[0] + 1, t[0] + 1, t[1] + 1, t[1] + 1,
                      t[2] + 1, t[2] + 1));
  return text;
}

std::string mesh_glb(const TriangleMesh& mesh) {
  if (mesh.empty()) throw Error("a mesh without triangles cannot be written as glTF, which allows no empty buffer");
  std::string data;
  for (const MeshVertex& vertex : mesh.vertices) {
    put(data, vertex.position);
    put(data, vertex.normal.norm() > 0.5F ? vertex.normal : Eigen::Vector3f(Eigen::Vector3f::UnitY()));
    for (const std::uint8_t value : {vertex.red, vertex.green, vertex.blue}) put(data, linear(value));
    put(data, std::uint16_t{65535});
  }
  const std::size_t vertex_bytes = data.size();
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle) put(data, corner);
  const std::string description = gltf_description(mesh, vertex_bytes, data.size() - vertex_bytes).dump();
  std::string chunks;
  put_chunk(chunks, 0x4E4F534A, description, ' ');
  put_chunk(chunks, 0x004E4942, std::move(data), '\0');
  std::string bytes = "glTF";
  put(bytes, std::uint32_t{2});
  put(bytes, static_cast<std::uint32_t>(12 + chunks.size()));
  return bytes + chunks;
}

void require_mesh_name(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  for (const std::string& format : mesh_formats())
    if (ending == "." + format) return;
  throw InputError({file.string()}, "is no name of a mesh; expected one that ends in .ply, .obj or .glb");
}

void write_mesh(const std::filesystem::path& file, const TriangleMesh& mesh) {
  require_mesh_name(file);
  const std::string ending = file.extension().string();
  write_file_atomically(file, ending == ".ply" ? mesh_ply(mesh) : ending == ".obj" ? mesh_obj(mesh) : mesh_glb(mesh));
}

}  // namespace holdfast
