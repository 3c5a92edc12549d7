// SPDX-License-Identifier: BSD-3-Clause
#include "posed_world.hpp"

#include <algorithm>
#include <cmath>

namespace holdfast::simulation {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {
void bound(PosedObject& object) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& corner : object.corners) box.extend(corner);
  object.centre = object.corners.empty() ? Vector3d(Vector3d::Zero()) : Vector3d(box.center());
  double radius2 = 0.0;
  for (const Vector3d& corner : object.corners) radius2 = std::max(radius2, (corner - object.centre).squaredNorm());
  object.radius = std::sqrt(radius2);
}
}  // namespace

PosedWorld::PosedWorld(const World& world) : world_(world) {
  std::uint32_t first_surface = 0;
  for (const Object& object : world.objects) {
    PosedObject& posed = objects_.emplace_back();
    posed.object = &object;
    posed.first_surface = first_surface;
    first_surface += object.mesh.surface_count;
    if (object.moves()) continue;
    for (const Vertex& vertex : object.mesh.vertices) {
      posed.corners.push_back(object.T_world_object * vertex.position.cast<double>());
      posed.light.push_back(vertex.light);
    }
    bound(posed);
  }
}

void PosedWorld::pose(double time) {
  shadows_.clear();
  for (PosedObject& object : objects_) {
    if (!object.object->moves()) continue;
    pose_vertices(*object.object, time, posed_);
    object.corners.resize(posed_.size());
    for (std::size_t i = 0; i < posed_.size(); ++i) object.corners[i] = posed_[i].position.cast<double>();
    bound(object);
    light(object, posed_);
    add_contact_shadows(*object.object, posed_, shadows_);
  }
}

void PosedWorld::light(PosedObject& object, const std::vector<PosedVertex>& posed) const {
  object.light.resize(posed.size());
  for (std::size_t i = 0; i < posed.size(); ++i) {
    float light = world_.ambient * object.object->mesh.vertices[i].light;
    for (const Lamp& lamp : world_.lamps) light += lamp.light(posed[i].position, posed[i].normal);
    object.light[i] = light;
  }
}

}  // namespace holdfast::simulation
