// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "holdfast/simulation/world.hpp"

namespace holdfast::simulation {

using Eigen::Vector3f;

namespace {
constexpr float reach = 0.45F;  // how far ambient occlusion looks [m]

struct Occluder {
  Eigen::AlignedBox3f box;  // in the object's frame
  Eigen::Isometry3f T_object_world;
  Vector3f centre;  // world
  float radius;
};

// Where the segment from + t * direction, 0 < t < 1, enters the box; 1 when it does not.
float first_hit(const Occluder& occluder, const Vector3f& from, const Vector3f& direction) {
  const Vector3f origin = occluder.T_object_world * from;
  const Vector3f along = occluder.T_object_world.linear() * direction;
  float enter = 0.0F, leave = 1.0F;
  for (int axis = 0; axis < 3; ++axis) {
    const float low = occluder.box.min()[axis] - origin[axis], high = occluder.box.max()[axis] - origin[axis];
    if (std::abs(along[axis]) < 1e-9F) {
      if (low > 0.0F || high < 0.0F) return 1.0F;
      continue;
    }
    const float one = low / along[axis], other = high / along[axis];
    enter = std::max(enter, std::min(one, other));
    leave = std::min(leave, std::max(one, other));
  }
  return enter < leave ? enter : 1.0F;
}

// Whether no part of the box lies before the plane through the point.
bool lies_behind(const Occluder& occluder, const Vector3f& point, const Vector3f& normal) {
  const Vector3f along = occluder.T_object_world.linear() * normal;
  const Vector3f to_centre = occluder.box.center() - occluder.T_object_world * point;
  return along.dot(to_centre) + 0.5F * along.cwiseAbs().dot(occluder.box.sizes()) <= 0.0F;
}

// Directions over the hemisphere, denser towards the normal as Lambert's law weighs them (Malley's method on a
// Fibonacci spiral).
std::vector<Vector3f> hemisphere(int count) {
  std::vector<Vector3f> directions;
  for (int i = 0; i < count; ++i) {
    const float share = (static_cast<float>(i) + 0.5F) / static_cast<float>(count);
    const float angle = static_cast<float>(i) * std::numbers::pi_v<float> * (3.0F - std::sqrt(5.0F));
    const float radius = std::sqrt(share);
    directions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1.0F - share));
  }
  return directions;
}

float openness(const Vector3f& point, const Vector3f& normal, const std::vector<const Occluder*>& near,
               const std::vector<Vector3f>& directions) {
  if (near.empty()) return 1.0F;
  const Vector3f side = normal.unitOrthogonal(), other = normal.cross(side);
  float open = 0.0F;
  for (const Vector3f& direction : directions) {
    const Vector3f along = reach * (direction.x() * side + direction.y() * other + direction.z() * normal);
    float hit = 1.0F;
    for (const Occluder* occluder : near) hit = std::min(hit, first_hit(*occluder, point, along));
    open += hit;
  }
  return open / static_cast<float>(directions.size());
}

// Space in cubes, each with the occluders that may matter to points in it, so that baking a large room costs no more
// per vertex than a small one. What is left out could not be hit: light is the same as with all of them.
class Neighbourhood {
 public:
  Neighbourhood(const std::vector<Occluder>& occluders, const std::vector<Lamp>& lamps)
      : occluders_(occluders), lamps_(lamps) {}

  struct Cell {
    std::vector<const Occluder*> near;                   // for ambient occlusion
    std::vector<std::vector<const Occluder*>> to_lamps;  // on the way to each lamp
  };

  const Cell& at(const Vector3f& point) {
    const std::array<int, 3> key = {static_cast<int>(std::floor(point.x() / side)),
                                    static_cast<int>(std::floor(point.y() / side)),
                                    static_cast<int>(std::floor(point.z() / side))};
    const auto [entry, is_new] = cells_.try_emplace(key);
    if (is_new) fill(entry->second, side * (Vector3f(key[0], key[1], key[2]) + Vector3f::Constant(0.5F)));
    return entry->second;
  }

 private:
  static constexpr float side = 0.5F;

  void fill(Cell& cell, const Vector3f& centre) const {
    const float cell_radius = 0.5F * side * std::sqrt(3.0F) + 1e-4F;
    cell.to_lamps.resize(lamps_.size());
    for (const Occluder& occluder : occluders_) {
      const Vector3f to_occluder = occluder.centre - centre;
      if (to_occluder.norm() < occluder.radius + cell_radius + reach) cell.near.push_back(&occluder);
      for (std::size_t i = 0; i < lamps_.size(); ++i) {
        const Vector3f to_lamp = lamps_[i].position - centre;
        const float share = std::clamp(to_occluder.dot(to_lamp) / to_lamp.squaredNorm(), 0.0F, 1.0F);
        if ((to_occluder - share * to_lamp).norm() < occluder.radius + cell_radius)
          cell.to_lamps[i].push_back(&occluder);
      }
    }
  }

  const std::vector<Occluder>& occluders_;
  const std::vector<Lamp>& lamps_;
  std::map<std::array<int, 3>, Cell> cells_;
};

// An object that moves takes its own shade along, nothing else's.
void bake_openness(Object& object, const std::vector<Vector3f>& directions) {
  std::vector<Occluder> occluders;
  for (const Eigen::AlignedBox3f& box : object.mesh.solids)
    occluders.push_back({box, Eigen::Isometry3f::Identity(), box.center(), 0.5F * box.diagonal().norm()});
  std::vector<const Occluder*> all;
  for (const Occluder& occluder : occluders) all.push_back(&occluder);
  if (all.empty()) return;
  for (Vertex& vertex : object.mesh.vertices)
    vertex.light = openness(vertex.position + 0.004F * vertex.normal, vertex.normal, all, directions);
}
}  // namespace

void bake_light(World& world) {
  std::vector<Occluder> occluders;
  for (const Object& object : world.objects) {
    if (object.moves()) continue;
    const Eigen::Isometry3f T_world_object = object.T_world_object.cast<float>();
    for (const Eigen::AlignedBox3f& box : object.mesh.solids)
      occluders.push_back({box, T_world_object.inverse(), T_world_object * box.center(), 0.5F * box.diagonal().norm()});
  }
  const std::vector<Vector3f> directions = hemisphere(20);
  Neighbourhood neighbourhood(occluders, world.lamps);

  std::vector<const Occluder*> near;
  for (Object& object : world.objects) {
    if (object.moves()) {
      bake_openness(object, directions);
      continue;
    }
    const Eigen::Isometry3f T_world_object = object.T_world_object.cast<float>();
    for (Vertex& vertex : object.mesh.vertices) {
      const Vector3f normal = T_world_object.linear() * vertex.normal;
      const Vector3f point = T_world_object * vertex.position + 0.004F * normal;  // clear of its own solid
      const Neighbourhood::Cell& cell = neighbourhood.at(point);
      near.clear();
      for (const Occluder* occluder : cell.near)
        if ((occluder->centre - point).norm() < occluder->radius + reach && !lies_behind(*occluder, point, normal))
          near.push_back(occluder);
      float light = world.ambient * openness(point, normal, near, directions);
      for (std::size_t i = 0; i < world.lamps.size(); ++i) {
        const float unhidden = world.lamps[i].light(point, normal);
        if (unhidden <= 0.0F) continue;
        const Vector3f to_lamp = world.lamps[i].position - point;
        // A lamp has an extent: an occluder near the ray's middle takes all light, one that ends at the lamp none.
        const bool lit = std::none_of(cell.to_lamps[i].begin(), cell.to_lamps[i].end(), [&](const Occluder* occluder) {
          return first_hit(*occluder, point, 0.95F * to_lamp) < 1.0F;
        });
        light += unhidden * (lit ? 1.0F : 0.25F);
      }
      vertex.light = light;
    }
  }
}

}  // namespace holdfast::simulation
