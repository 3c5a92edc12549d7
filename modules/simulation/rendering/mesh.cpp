// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/mesh.hpp"

#include <cmath>

#include "full_turn.hpp"

namespace holdfast::simulation {

using Eigen::Vector3f;

namespace {

std::uint32_t add_vertex(Mesh& mesh, const Vector3f& position, const Vector3f& normal, float u, float v) {
  mesh.vertices.push_back({position, normal, u, v, 1.0F});
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

// Corners as seen from outside: upper left, upper right, lower right, lower left.
void add_quad(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, std::uint32_t texture,
              std::uint32_t surface) {
  mesh.triangles.push_back({a, b, c, texture, surface});
  mesh.triangles.push_back({a, c, d, texture, surface});
}

void add_disc(Mesh& mesh, const Vector3f& centre, float radius, float up, const TextureArea& area, int facets) {
  const std::uint32_t surface = mesh.surface_count++;
  const Vector3f normal(0, 0, up);
  const std::uint32_t middle =
      add_vertex(mesh, centre, normal, area.u + 0.5F * area.width, area.v + 0.5F * area.height);
  std::vector<std::uint32_t> rim;
  for (int i = 0; i < facets; ++i) {
    const float angle = full_turn<float> * static_cast<float>(i) / static_cast<float>(facets);
    const float x = std::cos(angle), y = std::sin(angle);
    rim.push_back(add_vertex(mesh, centre + radius * Vector3f(x, y, 0), normal, area.u + (0.5F + 0.5F * x) * area.width,
                             area.v + (0.5F - 0.5F * y) * area.height));
  }
  for (int i = 0; i < facets; ++i) {
    const std::uint32_t one = rim[i], next = rim[(i + 1) % facets];
    if (up > 0)
      mesh.triangles.push_back({middle, next, one, area.texture, surface});
    else
      mesh.triangles.push_back({middle, one, next, area.texture, surface});
  }
}
}  // namespace

void add_rectangle(Mesh& mesh, const Vector3f& origin, const Vector3f& right, const Vector3f& down,
                   const TextureArea& area, float cell) {
  const int columns = std::max(1, static_cast<int>(std::ceil(right.norm() / cell)));
  const int rows = std::max(1, static_cast<int>(std::ceil(down.norm() / cell)));
  const Vector3f normal = down.cross(right).normalized();
  const std::uint32_t surface = mesh.surface_count++;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const float s = static_cast<float>(i) / static_cast<float>(columns);
      const float t = static_cast<float>(j) / static_cast<float>(rows);
      add_vertex(mesh, origin + s * right + t * down, normal, area.u + s * area.width, area.v + t * area.height);
    }
  const auto stride = static_cast<std::uint32_t>(columns + 1);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const std::uint32_t a = first + static_cast<std::uint32_t>(j) * stride + static_cast<std::uint32_t>(i);
      add_quad(mesh, a, a + 1, a + stride + 1, a + stride, area.texture, surface);
    }
}

void add_box(Mesh& mesh, const Eigen::AlignedBox3f& box, const BoxSkin& skin, float cell, bool solid) {
  const Vector3f size = box.sizes(), low = box.min(), high = box.max();
  const Vector3f x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  add_rectangle(mesh, {low.x(), low.y(), high.z()}, x, -z, skin[front], cell);
  add_rectangle(mesh, {high.x(), high.y(), high.z()}, -x, -z, skin[back], cell);
  add_rectangle(mesh, {low.x(), high.y(), high.z()}, -y, -z, skin[left], cell);
  add_rectangle(mesh, {high.x(), low.y(), high.z()}, y, -z, skin[right], cell);
  add_rectangle(mesh, {low.x(), high.y(), high.z()}, x, -y, skin[top], cell);
  add_rectangle(mesh, {low.x(), low.y(), low.z()}, x, y, skin[bottom], cell);
  if (solid) mesh.solids.push_back(box);
}

void add_cylinder(Mesh& mesh, const Vector3f& base, float bottom_radius, float top_radius, float height,
                  const TextureArea& side, const TextureArea& cap, int facets, bool solid) {
  const std::uint32_t surface = mesh.surface_count++;
  std::vector<std::uint32_t> upper, lower;
  for (int i = 0; i <= facets; ++i) {
    const float share = static_cast<float>(i) / static_cast<float>(facets), angle = full_turn<float> * share;
    const Vector3f out(std::cos(angle), std::sin(angle), 0);
    const Vector3f normal = (out * height + Vector3f(0, 0, bottom_radius - top_radius)).normalized();
    const float u = side.u + share * side.width;
    upper.push_back(add_vertex(mesh, base + top_radius * out + Vector3f(0, 0, height), normal, u, side.v));
    lower.push_back(add_vertex(mesh, base + bottom_radius * out, normal, u, side.v + side.height));
  }
  for (int i = 0; i < facets; ++i)
    add_quad(mesh, upper[i], upper[i + 1], lower[i + 1], lower[i], side.texture, surface);
  if (top_radius > 0) add_disc(mesh, base + Vector3f(0, 0, height), top_radius, 1.0F, cap, facets);
  if (bottom_radius > 0) add_disc(mesh, base, bottom_radius, -1.0F, cap, facets);
  if (solid) {
    const float radius = 0.8F * std::max(bottom_radius, top_radius);  // the square inside and outside in balance
    mesh.solids.emplace_back(base - Vector3f(radius, radius, 0), base + Vector3f(radius, radius, height));
  }
}

void add_bar(Mesh& mesh, const std::vector<Vector3f>& points, float radius, const TextureArea& area, int facets) {
  const std::uint32_t surface = mesh.surface_count++;
  std::vector<std::uint32_t> before;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vector3f along = (points[std::min(k + 1, points.size() - 1)] - points[k > 0 ? k - 1 : 0]).normalized();
    const Vector3f side = along.unitOrthogonal(), other = along.cross(side);
    const float share = static_cast<float>(k) / static_cast<float>(points.size() - 1);
    std::vector<std::uint32_t> ring;
    for (int i = 0; i <= facets; ++i) {
      const float part = static_cast<float>(i) / static_cast<float>(facets);
      const Vector3f out = std::cos(full_turn<float> * part) * side + std::sin(full_turn<float> * part) * other;
      ring.push_back(add_vertex(mesh, points[k] + radius * out, out, area.u + part * area.width,
                                area.v + (1.0F - share) * area.height));
    }
    for (int i = 0; k > 0 && i < facets; ++i)
      add_quad(mesh, ring[i], ring[i + 1], before[i + 1], before[i], area.texture, surface);
    before = std::move(ring);
  }
}

}  // namespace holdfast::simulation
