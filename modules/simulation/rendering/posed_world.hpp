// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "contact_shadow.hpp"
#include "holdfast/simulation/world.hpp"

namespace holdfast::simulation {

/// An object where it is at a moment, in the world's frame.
struct PosedObject {
  const Object* object = nullptr;
  std::uint32_t first_surface = 0;       ///< number of its first surface among those of all objects
  std::vector<Eigen::Vector3d> corners;  ///< of its vertices [m]
  std::vector<float> light;              ///< brightness of its vertices
  Eigen::Vector3d centre;                ///< of a sphere that holds all corners
  double radius = 0.0;
};

/// A world at a moment. What stands still is computed once and keeps its baked light; what moves is posed anew for each
/// moment and lit by Lambert's law from every lamp without shadows, plus the world's ambient light times Vertex::light,
/// which holds how open the vertex is (see bake_light).
class PosedWorld {
 public:
  /// The world must outlive this.
  explicit PosedWorld(const World& world);

  /// Poses what moves.
  void pose(double time);

  const World& world() const { return world_; }
  /// In the order of World::objects.
  const std::vector<PosedObject>& objects() const { return objects_; }
  /// Of all that moves.
  const std::vector<ContactShadow>& shadows() const { return shadows_; }

 private:
  void light(PosedObject& object, const std::vector<PosedVertex>& posed) const;

  const World& world_;
  std::vector<PosedObject> objects_;
  std::vector<ContactShadow> shadows_;
  std::vector<PosedVertex> posed_;  // of the object at hand
};

}  // namespace holdfast::simulation
