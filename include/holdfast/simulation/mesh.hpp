// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

namespace holdfast::simulation {

/// A corner of a triangle, in the frame of its object [m].
struct Vertex {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;  ///< unit, outwards
  float u = 0.0F;          ///< texture position [texels of level 0]
  float v = 0.0F;
  float light = 1.0F;  ///< brightness; see bake_light
};

/// A triangle; a, b, c are clockwise in an image from outside (x right, y down).
struct Triangle {
  std::uint32_t a, b, c;
  std::uint32_t texture;  ///< index in World::textures
  std::uint32_t surface;  ///< shared by the triangles of one smooth surface, between which no edge is drawn
};

/// A rectangle of a texture, in texels of level 0.
struct TextureArea {
  std::uint32_t texture = 0;
  float u = 0.0F, v = 0.0F;  ///< upper left corner
  float width = 1.0F, height = 1.0F;
};

/// Skinning weights of a vertex: indices and weights of at most four bones. The weights are not negative and sum to
/// one.
struct SkinWeights {
  std::array<std::uint8_t, 4> bones{};
  std::array<float, 4> weights{1.0F, 0.0F, 0.0F, 0.0F};
};

/// Textured triangles, and boxes that approximate them for shadows.
struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<Triangle> triangles;
  std::vector<Eigen::AlignedBox3f> solids;
  std::uint32_t surface_count = 0;
  /// For a skinned mesh: the weights of each vertex, and T_object_bone of each bone (by index) in the rest pose, in
  /// which the vertices are given. Empty for a rigid mesh.
  std::vector<SkinWeights> skin;
  std::vector<Eigen::Isometry3d> rest;
};

/// The sides of a box in the order of the textures of add_box. z points up and the viewer is at -y: front is -y, right
/// is +x.
enum BoxSide { front, back, left, right, top, bottom };
using BoxSkin = std::array<TextureArea, 6>;

/// Adds a rectangle. `origin` is the corner with the upper left of the texture, `right` and `down` are its edges as
/// seen from outside. It is divided into cells of at most `cell` [m], so that light can vary over it.
void add_rectangle(Mesh& mesh, const Eigen::Vector3f& origin, const Eigen::Vector3f& right, const Eigen::Vector3f& down,
                   const TextureArea& area, float cell = 0.25F);

/// Adds an axis-aligned box with its outside textured. `solid`: it also casts shadows.
void add_box(Mesh& mesh, const Eigen::AlignedBox3f& box, const BoxSkin& skin, float cell = 0.25F, bool solid = true);

/// Adds an upright cylinder (or a truncated cone, with two radii) on `base`. The texture `side` covers the side once,
/// the disc in `cap` the top and the bottom.
void add_cylinder(Mesh& mesh, const Eigen::Vector3f& base, float bottom_radius, float top_radius, float height,
                  const TextureArea& side, const TextureArea& cap, int facets = 16, bool solid = true);

/// Adds a round bar along a polyline, for cables, chair legs and lamp arms.
void add_bar(Mesh& mesh, const std::vector<Eigen::Vector3f>& points, float radius, const TextureArea& area,
             int facets = 5);

}  // namespace holdfast::simulation
