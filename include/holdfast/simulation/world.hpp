// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/simulation/mesh.hpp"
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

  bool moves() const { return static_cast<bool>(motion); }
  Eigen::Isometry3d pose(double time) const { return motion ? motion(time) : T_world_object; }
};

/// A lamp that shines from a point in all directions.
struct Lamp {
  Eigen::Vector3f position;
  float brightness = 1.0F;  ///< of a white surface at 1 m that faces it; falls with 1 / (0.5 + 0.5 distance^2)
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

/// Sets Vertex::light of every object, for the poses at rest: Lambert's law for each lamp, with shadows, and ambient
/// light dimmed by what stands near (ambient occlusion; Zhukov et al. 1998). Mesh::solids stand for the objects.
void bake_light(World& world);

/// Names of the object classes in the world, sorted, after "background" at 0.
std::vector<std::string> class_names(const World& world);

}  // namespace holdfast::simulation
