// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/simulation/mesh.hpp"
#include "holdfast/simulation/skeleton.hpp"
#include "holdfast/simulation/texture.hpp"

namespace holdfast::simulation {

/// A thing in the world, named by its number in World::objects plus one (0 means nothing).
struct Object {
  std::string name;        ///< "desk 1"
  std::string class_name;  ///< "desk"
  Mesh mesh;
  Eigen::Isometry3d T_world_object = Eigen::Isometry3d::Identity();  ///< at rest
  /// T_world_object at a time [s] for a thing that moves; empty for one that stands still.
  std::function<Eigen::Isometry3d(double)> motion;
  /// For a mesh with a skin: T_object_bone of each bone at a time [s]; empty for a rigid mesh.
  std::function<BonePoses(double)> bones;

  bool moves() const { return motion || bones; }
  Eigen::Isometry3d pose(double time) const { return motion ? motion(time) : T_world_object; }
};

/// A corner of a mesh where it is at a moment, in the world's frame.
struct PosedVertex {
  Eigen::Vector3f position;  ///< [m]
  Eigen::Vector3f normal;    ///< unit
};

/// Where every `stride`-th vertex of an object is at a time [s]: vertex i stride in place i of `posed`, which is
/// resized. A mesh with a skin bends by linear blending: the sum over its bones of weight * T_object_bone(time) *
/// T_bone_object(rest) is applied to the vertex (Magnenat-Thalmann, Laperriere and Thalmann, Graphics Interface 1988).
void pose_vertices(const Object& object, double time, std::vector<PosedVertex>& posed, std::size_t stride = 1);

/// Whether any of the object's surface moves faster than 10 cm/s around a time [s]: a part of its vertices is compared
/// between a sixtieth of a second before and after. People who sit or stand breathe, sway and look about more slowly.
bool moves_at(const Object& object, double time);

/// A lamp that shines from a point in all directions.
struct Lamp {
  Eigen::Vector3f position;
  float brightness = 1.0F;  ///< of a white surface at 1 m that faces it; falls with 1 / (0.5 + 0.5 distance^2)

  /// What a surface at `point` gets that nothing hides from the lamp (Lambert's law).
  float light(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const {
    const Eigen::Vector3f to_lamp = position - point;
    const float distance2 = to_lamp.squaredNorm();
    const float along = normal.dot(to_lamp);
    return along > 0.0F ? brightness * along / (std::sqrt(distance2) * (0.5F + 0.5F * distance2)) : 0.0F;
  }
};

/// All there is: z up, floor at z = 0 [m].
struct World {
  std::vector<Texture> textures;
  std::vector<Object> objects;
  std::vector<Lamp> lamps;
  float ambient = 0.5F;  ///< light that comes from everywhere

  /// Adds a picture (8UC3) and gives the area that holds all of it.
  TextureArea add_texture(const cv::Mat& picture);
};

/// Sets Vertex::light of every object that stands still: Lambert's law for each lamp, with shadows, and ambient light
/// dimmed by what stands near (ambient occlusion; Zhukov et al. 1998). Mesh::solids stand for the objects. An object
/// that moves is lit anew in each frame: Vertex::light becomes the share of ambient light (0 to 1) that its own solids
/// leave, and stays what it was without solids.
void bake_light(World& world);

/// Names of the object classes in the world, sorted, after "background" at 0.
std::vector<std::string> class_names(const World& world);

}  // namespace holdfast::simulation
