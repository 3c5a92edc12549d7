// SPDX-License-Identifier: BSD-3-Clause
#include "marching_cubes.hpp"

#include <algorithm>
#include <cmath>

#include "cube_cases.hpp"

namespace holdfast::surface {

namespace {

/// The vertices of a block: those on edges that begin at its voxels. Edge 3 * voxel + axis.
struct BlockVertices {
  std::uint32_t first = 0;           ///< position of its first vertex in the mesh
  std::vector<std::uint16_t> edges;  ///< increasing
};

/// Values of a block and of the first layer of its neighbours, 9^3.
struct Neighbourhood {
  static constexpr int side = Block::side + 1;
  std::array<float, static_cast<std::size_t>(side* side* side)> values{};
  std::array<std::int32_t, 8> blocks{};  ///< by 4 * (next in x) + 2 * (next in y) + (next in z); -1 = none

  float at(int x, int y, int z) const { return values[static_cast<std::size_t>((x * side + y) * side + z)]; }
};

bool is_crossed(float a, float b) { return !std::isnan(a) && !std::isnan(b) && (a < 0.0F) != (b < 0.0F); }

class Marcher {
 public:
  Marcher(const Blocks& blocks, double voxel, int minimum_views)
      : blocks_(blocks), voxel_(static_cast<float>(voxel)), minimum_views_(minimum_views) {}

  TriangleMesh run() {
    const std::size_t count = blocks_.list().size();
    vertices_.resize(count);
    for (std::size_t i = 0; i < count; ++i) make_vertices(i);
    for (std::size_t i = 0; i < count; ++i) make_triangles(i);
    spread_colours();
    return std::move(mesh_);
  }

 private:
  void gather(std::size_t number, Neighbourhood& around) const {
    const Block& block = *blocks_.list()[number];
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector3i offset((k >> 2) & 1, (k >> 1) & 1, k & 1);
      around.blocks[static_cast<std::size_t>(k)] =
          k == 0 ? static_cast<std::int32_t>(number) : blocks_.find(block.coordinates + offset);
    }
    constexpr int side = Neighbourhood::side;
    std::size_t i = 0;
    for (int x = 0; x < side; ++x)
      for (int y = 0; y < side; ++y)
        for (int z = 0; z < side; ++z, ++i) {
          const int k = 4 * (x / Block::side) + 2 * (y / Block::side) + z / Block::side;
          const std::int32_t owner = around.blocks[static_cast<std::size_t>(k)];
          around.values[i] = owner < 0
                                 ? std::numeric_limits<float>::quiet_NaN()
                                 : blocks_.list()[static_cast<std::size_t>(owner)]->value(
                                       Block::index(x % Block::side, y % Block::side, z % Block::side), minimum_views_);
        }
  }

  void make_vertices(std::size_t number) {
    Neighbourhood around;
    gather(number, around);
    BlockVertices& own = vertices_[number];
    own.first = static_cast<std::uint32_t>(mesh_.vertices.size());
    for (int i = 0; i < Block::size; ++i) {
      const Eigen::Vector3i place(i / 64, i / 8 % 8, i % 8);
      const float value = around.at(place.x(), place.y(), place.z());
      if (std::isnan(value)) continue;
      for (int axis = 0; axis < 3; ++axis) {
        Eigen::Vector3i other = place;
        ++other[axis];
        const float next = around.at(other.x(), other.y(), other.z());
        if (!is_crossed(value, next)) continue;
        own.edges.push_back(static_cast<std::uint16_t>(3 * i + axis));
        // Away from the ends, where vertices of several edges would coincide.
        add_vertex(number, around, place, other, axis, std::clamp(value / (value - next), 0.01F, 0.99F));
      }
    }
  }

  void add_vertex(std::size_t number, const Neighbourhood& around, const Eigen::Vector3i& place,
                  const Eigen::Vector3i& other, int axis, float along) {
    MeshVertex vertex;
    vertex.position = (blocks_.list()[number]->coordinates * Block::side + place).cast<float>();
    vertex.position[axis] += along;
    vertex.position *= voxel_;
    // The colour of the nearer end, or of the other one if that has none.
    const bool other_is_nearer = along > 0.5F;
    has_colour_.push_back(set_colour(vertex, around, other_is_nearer ? other : place) ||
                          set_colour(vertex, around, other_is_nearer ? place : other));
    mesh_.vertices.push_back(vertex);
  }

  bool set_colour(MeshVertex& vertex, const Neighbourhood& around, const Eigen::Vector3i& place) const {
    const Eigen::Vector3i next = place / Block::side;
    const std::int32_t owner = around.blocks[static_cast<std::size_t>(4 * next.x() + 2 * next.y() + next.z())];
    if (owner < 0) return false;
    const Block& block = *blocks_.list()[static_cast<std::size_t>(owner)];
    if (!block.colour) return false;
    const Block::Colour& colour = (*block.colour)[static_cast<std::size_t>(
        Block::index(place.x() % Block::side, place.y() % Block::side, place.z() % Block::side))];
    if (colour.count == 0) return false;
    const auto mean = [&](int sum) { return static_cast<std::uint8_t>((sum + colour.count / 2) / colour.count); };
    vertex.red = mean(colour.red), vertex.green = mean(colour.green), vertex.blue = mean(colour.blue);
    vertex.label = label_of(block, static_cast<std::size_t>(&colour - block.colour->data()));
    return true;
  }

  /// Gives vertices without colour, at the rims of free space, the mean colour of their neighbours, and their smallest
  /// label.
  void spread_colours() {
    constexpr int passes = 8;
    struct Sum {
      std::uint32_t vertex = 0;
      int red = 0, green = 0, blue = 0, count = 0;
      std::uint8_t label = MeshVertex::unknown_class;
    };
    for (int pass = 0; pass < passes; ++pass) {
      std::vector<Sum> sums;
      std::vector<std::uint32_t> place(mesh_.vertices.size(), 0);  // in sums, plus one
      for (const auto& triangle : mesh_.triangles)
        for (const std::uint32_t to : triangle) {
          if (has_colour_[to]) continue;
          for (const std::uint32_t from : triangle) {
            if (!has_colour_[from]) continue;
            if (place[to] == 0) {
              sums.push_back({.vertex = to});
              place[to] = static_cast<std::uint32_t>(sums.size());
            }
            Sum& sum = sums[place[to] - 1];
            const MeshVertex& vertex = mesh_.vertices[from];
            sum.red += vertex.red, sum.green += vertex.green, sum.blue += vertex.blue, ++sum.count;
            sum.label = std::min(sum.label, vertex.label);
          }
        }
      if (sums.empty()) return;
      for (const Sum& sum : sums) {
        MeshVertex& vertex = mesh_.vertices[sum.vertex];
        vertex.red = static_cast<std::uint8_t>(sum.red / sum.count);
        vertex.green = static_cast<std::uint8_t>(sum.green / sum.count);
        vertex.blue = static_cast<std::uint8_t>(sum.blue / sum.count);
        vertex.label = sum.label;
        has_colour_[sum.vertex] = true;
      }
    }
  }

  void make_triangles(std::size_t number) {
    Neighbourhood around;
    gather(number, around);
    for (int i = 0; i < Block::size; ++i) {
      const int x = i / 64, y = i / 8 % 8, z = i % 8;
      unsigned negative = 0;
      bool is_known = true;
      for (int corner = 0; corner < 8; ++corner) {
        const float value = around.at(x + CubeCases::corner_offset(corner, 0), y + CubeCases::corner_offset(corner, 1),
                                      z + CubeCases::corner_offset(corner, 2));
        is_known = is_known && !std::isnan(value);
        if (value < 0.0F) negative |= 1U << corner;
      }
      if (!is_known || negative == 0 || negative == 255) continue;
      for (const CubeCases::EdgeTriangle& edges : CubeCases::triangles(negative)) {
        std::array<std::uint32_t, 3> triangle{};
        for (std::size_t k = 0; k < 3; ++k) triangle[k] = vertex_of(around, x, y, z, edges[k]);
        mesh_.triangles.push_back(triangle);
      }
    }
  }

  /// The vertex on an edge of the cell at a voxel.
  std::uint32_t vertex_of(const Neighbourhood& around, int x, int y, int z, int edge) const {
    const int corner = edge / 3;
    x += CubeCases::corner_offset(corner, 0);
    y += CubeCases::corner_offset(corner, 1);
    z += CubeCases::corner_offset(corner, 2);
    const int k = 4 * (x / Block::side) + 2 * (y / Block::side) + z / Block::side;
    const BlockVertices& own = vertices_[static_cast<std::size_t>(around.blocks[static_cast<std::size_t>(k)])];
    const auto wanted =
        static_cast<std::uint16_t>(3 * Block::index(x % Block::side, y % Block::side, z % Block::side) + edge % 3);
    const auto found = std::lower_bound(own.edges.begin(), own.edges.end(), wanted);
    return own.first + static_cast<std::uint32_t>(found - own.edges.begin());
  }

  const Blocks& blocks_;
  float voxel_;
  int minimum_views_;
  TriangleMesh mesh_;
  std::vector<bool> has_colour_;  // of the vertices of mesh_
  std::vector<BlockVertices> vertices_;
};

}  // namespace

TriangleMesh march(const Blocks& blocks, double voxel, int minimum_views) {
  return Marcher(blocks, voxel, minimum_views).run();
}

}  // namespace holdfast::surface
