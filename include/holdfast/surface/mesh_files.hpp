// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/surface/triangle_mesh.hpp"

namespace holdfast {

/// The formats of write_mesh(): "ply", "obj", "glb".
const std::vector<std::string>& mesh_formats();

/// Formats a mesh as binary little-endian PLY: float x y z nx ny nz, uchar red green blue, and faces as lists of three
/// vertex_indices. A mesh with classes has besides: uchar label (255 = unknown), and a comment "label NUMBER NAME" for
/// each class.
std::string mesh_ply(const TriangleMesh& mesh);
/// Formats a mesh as Wavefront OBJ with normals; colours follow the position of a vertex, as most readers understand.
std::string mesh_obj(const TriangleMesh& mesh);
/// Formats a mesh as binary glTF 2.0. Colours are linear, as glTF requires, and the y axis points up: world coordinates
/// are rotated by -90 degrees about x, which the node undoes no more.
std::string mesh_glb(const TriangleMesh& mesh);

/// Throws InputError if the ending of a file names no format of meshes; for commands, before the work.
void require_mesh_name(const std::filesystem::path& file);

/// Writes a mesh atomically in the format that the ending of the file names. Throws InputError for another ending and
/// if it cannot be written.
void write_mesh(const std::filesystem::path& file, const TriangleMesh& mesh);

/// Reads a PLY file of any program, ASCII or binary: vertices with x, y, z (other properties are skipped; normals,
/// colours and labels, without their names, are read if present), and polygons, which are divided into triangles.
/// Throws InputError for a file that cannot be read, is damaged, has no triangle, or has a position that is not finite.
TriangleMesh read_mesh(const std::filesystem::path& file);

}  // namespace holdfast
