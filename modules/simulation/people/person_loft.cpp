// SPDX-License-Identifier: BSD-3-Clause
#include "person_loft.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "full_turn.hpp"

namespace holdfast::simulation {

using Eigen::Vector3f;

namespace {
constexpr float pole_size = 1e-4F;  // a ring smaller than this is a point [m]

float signed_power(float value, float power) { return std::copysign(std::pow(std::abs(value), power), value); }

bool is_pole(const Ring& ring) { return std::max({ring.width, ring.front, ring.back}) < pole_size; }

Vector3f ring_point(const Ring& ring, float share, float bulge) {
  const float sine = std::sin(full_turn<float> * share), cosine = std::cos(full_turn<float> * share);
  const float exponent = 2.0F / ring.power;
  const float depth = cosine > 0.0F ? ring.back : ring.front;
  const Vector3f outwards = -sine * ring.across + cosine * ring.behind;
  return ring.centre - signed_power(sine, exponent) * ring.width * ring.across +
         signed_power(cosine, exponent) * depth * ring.behind + bulge * outwards;
}

float girth(const Ring& ring) {  // Ramanujan 1914, first approximation
  const float a = ring.width, b = 0.5F * (ring.front + ring.back);
  return std::numbers::pi_v<float> * (3.0F * (a + b) - std::sqrt((3.0F * a + b) * (a + 3.0F * b)));
}

// Sums triangle normals by vertex. Vertices in the same place, as at the seam and at poles, share their sum.
void smooth_normals(Mesh& mesh, std::size_t first_vertex, std::size_t first_triangle, const Grid& grid) {
  std::vector<Vector3f> sums(grid.points.size(), Vector3f::Zero());
  for (std::size_t t = first_triangle; t < mesh.triangles.size(); ++t) {
    const Triangle& triangle = mesh.triangles[t];
    const Vector3f& a = mesh.vertices[triangle.a].position;
    const Vector3f normal = (mesh.vertices[triangle.c].position - a).cross(mesh.vertices[triangle.b].position - a);
    for (const std::uint32_t corner : {triangle.a, triangle.b, triangle.c}) sums[corner - first_vertex] += normal;
  }
  const auto columns = static_cast<std::size_t>(grid.columns);
  for (std::size_t begin = 0; begin < grid.points.size(); begin += columns) {
    const std::size_t end = begin + columns - 1;
    if (grid.points[begin] == grid.points[begin + columns / 2]) {
      Vector3f sum = Vector3f::Zero();
      for (std::size_t i = begin; i <= end; ++i) sum += sums[i];
      for (std::size_t i = begin; i <= end; ++i) sums[i] = sum;
    } else if (grid.closed) {
      sums[begin] = sums[end] = Vector3f(sums[begin] + sums[end]);
    }
    for (std::size_t i = begin; i <= end; ++i) mesh.vertices[first_vertex + i].normal = sums[i].normalized();
  }
}
}  // namespace

float smooth_step(float from, float to, float value) {
  const float t = std::clamp((value - from) / (to - from), 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

std::vector<float> ring_rows(const std::vector<Ring>& rings) {
  std::vector<float> rows = {0.0F};
  for (std::size_t k = 1; k < rings.size(); ++k) {
    float way = 0.0F;
    constexpr int samples = 8;
    for (int i = 0; i < samples; ++i) {
      const float share = (static_cast<float>(i) + 0.5F) / samples;
      way += (ring_point(rings[k], share, 0.0F) - ring_point(rings[k - 1], share, 0.0F)).norm() / samples;
    }
    rows.push_back(rows.back() + way);
  }
  return rows;
}

Eigen::Vector2f flat_size(const std::vector<Ring>& rings) {
  float around = 0.0F;
  for (const Ring& ring : rings) around = std::max(around, girth(ring));
  return {around, ring_rows(rings).back()};
}

void add_grid(Mesh& mesh, const Grid& grid, const TextureArea& area,
              const std::function<SkinWeights(const Vector3f&)>& weights) {
  const std::uint32_t surface = mesh.surface_count++;
  const auto first_vertex = static_cast<std::uint32_t>(mesh.vertices.size());
  const std::size_t first_triangle = mesh.triangles.size();
  const auto columns = static_cast<std::uint32_t>(grid.columns);
  for (std::size_t i = 0; i < grid.points.size(); ++i) {
    const std::size_t row = i / columns, column = i % columns;
    Vertex vertex;
    vertex.position = grid.points[i];
    vertex.u = area.u + static_cast<float>(column) / static_cast<float>(columns - 1) * area.width;
    vertex.v = area.v + (grid.rows[row] - grid.rows.front()) / (grid.rows.back() - grid.rows.front()) * area.height;
    mesh.skin.push_back(weights(vertex.position));
    mesh.vertices.push_back(vertex);
  }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (grid.points[a] == grid.points[b] || grid.points[b] == grid.points[c] || grid.points[a] == grid.points[c])
      return;  // at a pole
    mesh.triangles.push_back({first_vertex + a, first_vertex + b, first_vertex + c, area.texture, surface});
  };
  for (std::uint32_t row = 0; row + 1 < grid.rows.size(); ++row)
    for (std::uint32_t i = 0; i + 1 < columns; ++i) {
      const std::uint32_t upper = row * columns + i, lower = upper + columns;
      add(upper, upper + 1, lower + 1);
      add(upper, lower + 1, lower);
    }
  smooth_normals(mesh, first_vertex, first_triangle, grid);
}

void add_loft(Mesh& mesh, const Loft& loft, const TextureArea& area) {
  Grid grid;
  grid.columns = loft.facets + 1;
  grid.rows = ring_rows(loft.rings);
  for (std::size_t k = 0; k < loft.rings.size(); ++k)
    for (int i = 0; i <= loft.facets; ++i) {
      float share = loft.seam + static_cast<float>(i % loft.facets) / static_cast<float>(loft.facets);
      share -= std::floor(share);
      const Ring& ring = loft.rings[k];
      if (is_pole(ring))
        grid.points.push_back(ring.centre);
      else
        grid.points.push_back(ring_point(ring, share, loft.bulge ? loft.bulge(share, k) : 0.0F));
    }
  add_grid(mesh, grid, area, loft.weights);
}

SkinWeights chain_weights(float position, Bone first, std::initializer_list<ChainJoint> joints) {
  SkinWeights result;
  result.bones[0] = static_cast<std::uint8_t>(first);
  std::size_t last = 0;
  for (const ChainJoint& joint : joints) {
    const float share = smooth_step(joint.position - joint.half_blend, joint.position + joint.half_blend, position);
    if (share <= 0.0F) break;
    if (share >= 1.0F) {
      result = SkinWeights{};
      result.bones[0] = static_cast<std::uint8_t>(joint.after), last = 0;
      continue;
    }
    if (last == 3) break;  // joints are farther apart than they blend, so four are never needed
    const float before = result.weights[last];
    result.weights[last] = before * (1.0F - share);
    result.bones[++last] = static_cast<std::uint8_t>(joint.after);
    result.weights[last] = before * share;
  }
  return result;
}

}  // namespace holdfast::simulation
