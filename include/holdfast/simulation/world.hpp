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

/// An object of the world. Its id is its index in World::objects plus one (0 means nothing).
struct Object {
  std::string name;        ///< "desk 1"
  std::string class_name;  ///< "desk"
  Mesh mesh;
  Eigen::Isometry3d T_world_object = Eigen::Isometry3d::Identity();  ///< at rest
  /// T_world_object at a time [s] for a moving object; empty for a static one.
  std::function<Eigen::Isometry3d(double)> motion;
  /// For a mesh with a skin: T_object_bone of each bone at a time [s]; empty for a rigid mesh.
  std::function<BonePoses(double)> bones;

  bool moves() const { return motion || bones; }
  Eigen::Isometry3d pose(double time) const { return motion ? motion(time) : T_world_object; }
};

/// A vertex of a mesh at one time, in the world frame.
struct PosedVertex {
  Eigen::Vector3f position;  ///< [m]
  Eigen::Vector3f normal;    ///< unit
};

/// Computes every `stride`-th vertex of an object at a time [s]: posed[i] is vertex i * stride; `posed` is resized. A
/// skinned mesh is deformed by linear blend skinning: the sum over its bones of weight * T_object_bone(time) *
/// T_bone_object(rest) is applied to the vertex (Magnenat-Thalmann, Laperriere and Thalmann, Graphics Interface 1988).
void pose_vertices(const Object& object, double time, std::vector<PosedVertex>& posed, std::size_t stride = 1);

/// Whether a part of the object's surface moves faster than 10 cm/s at a time [s]: a subset of its vertices is compared
/// 1/60 s before and after. The idle motion of sitting and standing people is slower.
bool moves_at(const Object& object, double time);

/// A point light.
struct Lamp {
  Eigen::Vector3f position;
  float brightness = 1.0F;  ///< of a white facing surface at 1 m; decreases with 1 / (0.5 + 0.5 distance^2)

  /// Light on a surface at `point` without occlusion (Lambert's law).
  float light(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const {
    const Eigen::Vector3f to_lamp = position - point;
    const float distance2 = to_lamp.squaredNorm();
    const float along = normal.dot(to_lamp);
    return along > 0.0F ? brightness * along / (std::sqrt(distance2) * (0.5F + 0.5F * distance2)) : 0.0F;
  }
};

/// A complete world: z up, floor at z = 0 [m].
struct World {
  std::vector<Texture> textures;
  std::vector<Object> objects;
  std::vector<Lamp> lamps;
  float ambient = 0.5F;  ///< ambient light

  /// Adds a picture (8UC3) and returns its complete area.
  TextureArea add_texture(const cv::Mat& picture);
};

/// Computes Vertex::light of all static objects: Lambert's law for each lamp with shadows, and ambient occlusion
/// (Zhukov et al. 1998), with Mesh::solids as approximation of the objects. A moving object is lit in each frame: its
/// Vertex::light becomes the fraction of ambient light (0 to 1) that its own solids leave, and is unchanged without
/// solids.
void bake_light(World& world);

/// Names of the object classes in the world, sorted, after "background" at 0.
std::vector<std::string> class_names(const World& world);

}  // namespace holdfast::simulation
