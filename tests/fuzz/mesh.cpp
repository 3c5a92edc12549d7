// SPDX-License-Identifier: BSD-3-Clause
// Meshes in PLY format.
#include "fuzz.hpp"
#include "holdfast/surface/mesh_files.hpp"

using namespace holdfast;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::folder().write("mesh.ply", {data, size});
  TriangleMesh mesh;
  if (!fuzz::accepts([&] { mesh = read_mesh(file); })) return 0;
  fuzz::require(!mesh.empty(), "a mesh has triangles");
  for (const MeshVertex& vertex : mesh.vertices) fuzz::require(vertex.position.allFinite(), "positions are finite");
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle)
      fuzz::require(corner < mesh.vertices.size(), "the corners of triangles are vertices");
  mesh_ply(mesh);
  return 0;
}
