// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numbers>
#include <vector>

#include "holdfast/core/random.hpp"
#include "holdfast/simulation/pictures.hpp"
#include "holdfast/simulation/room.hpp"

namespace holdfast::simulation {

namespace {

/// A random permutation of 0 to count - 1 (Fisher and Yates).
std::vector<std::size_t> shuffled(std::size_t count, Random& random) {
  std::vector<std::size_t> order(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = i;
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
  return order;
}

/// Each chair at the place of another, turned and pushed a little.
void move_chairs(World& world, Random random) {
  constexpr double pushed = 0.35;  // m
  std::vector<Object*> chairs;
  std::vector<Eigen::Vector3d> places;
  for (Object& object : world.objects)
    if (object.class_name == "chair") {
      chairs.push_back(&object);
      places.emplace_back(object.T_world_object.translation());
    }
  const std::vector<std::size_t> order = shuffled(chairs.size(), random);
  for (std::size_t i = 0; i < chairs.size(); ++i) {
    const double yaw = random.uniform(-std::numbers::pi, std::numbers::pi);
    const double x = random.uniform(-pushed, pushed), y = random.uniform(-pushed, pushed);
    chairs[i]->T_world_object.translation() = places[order[i]] + Eigen::Vector3d(x, y, 0.0);
    chairs[i]->T_world_object.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  }
}

/// Each screen shows what another one showed, or something new, with equal chances. The front is the first side of a
/// monitor (RoomBuilder::monitor).
void change_screens(World& world, Random random) {
  std::vector<std::uint32_t> fronts;
  for (const Object& object : world.objects)
    if (object.class_name == "monitor") fronts.push_back(object.mesh.triangles.front().texture);
  std::sort(fronts.begin(), fronts.end());
  fronts.erase(std::unique(fronts.begin(), fronts.end()), fronts.end());  // repeated furniture shares its pictures
  std::vector<Texture> before;
  for (const std::uint32_t front : fronts) before.push_back(world.textures[front]);
  const std::vector<std::size_t> order = shuffled(2 * fronts.size(), random);
  for (std::size_t i = 0; i < fronts.size(); ++i) {
    Texture& texture = world.textures[fronts[i]];
    const std::size_t drawn = order[i];
    const bool is_new = drawn >= fronts.size() || drawn == i;
    texture = is_new ? Texture(pictures::screen({texture.width(), texture.height()}, random.fork(i))) : before[drawn];
  }
}

}  // namespace

void rearrange(World& world, std::uint64_t seed, std::uint64_t visit) {
  if (visit <= 1) return;
  const Random random = Random(seed).fork(0x7151).fork(visit);
  move_chairs(world, random.fork(1));
  change_screens(world, random.fork(2));
}

}  // namespace holdfast::simulation
