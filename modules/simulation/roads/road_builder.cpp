// SPDX-License-Identifier: BSD-3-Clause
#include "road_builder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rooms/measures.hpp"

namespace holdfast::simulation {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {
constexpr float ribbon_cell = 2.5F;  // [m]

const TextureArea& any_of(const std::vector<TextureArea>& areas, Random& random) {
  return areas[random.below(static_cast<std::uint32_t>(areas.size()))];
}

BoxSkin all_sides(const TextureArea& area) { return {area, area, area, area, area, area}; }
}  // namespace

RoadBuilder::RoadBuilder(World& world, const RoadPlan& plan, std::uint64_t seed)
    : world_(world),
      plan_(plan),
      profile_(road_profile(plan.kind)),
      course_(plan, seed),
      random_(Random(seed).fork(0x70ad5)),
      stock_(world, plan.kind, random_.fork(1)) {}

Object& RoadBuilder::add(const std::string& class_name, const Isometry3d& T_world_object) {
  Object& object = world_.objects.emplace_back();
  object.class_name = class_name;
  object.name = class_name + " " + std::to_string(++counts_[class_name]);
  object.T_world_object = T_world_object;
  return object;
}

void RoadBuilder::bend(Object& object, double from) const {
  object.T_world_object = course_.frame(from);
  const Isometry3d T_object_world = object.T_world_object.inverse();
  for (Vertex& vertex : object.mesh.vertices) {
    const Vector3d position = vertex.position.cast<double>();
    const Isometry3d T_object_here = T_object_world * course_.frame(from + position.x(), position.y());
    vertex.position = (T_object_here * Vector3d(0, 0, position.z())).cast<float>();
    vertex.normal = (T_object_here.linear() * vertex.normal.cast<double>()).cast<float>();
  }
}

void RoadBuilder::lie(Object& object, double right, double left, double height, const TextureArea& area) const {
  const Vector3d corner(0, left, height), along(stretch_length, 0, 0), down(0, right - left, 0);
  add_rectangle(object.mesh, corner.cast<float>(), along.cast<float>(), down.cast<float>(), area, ribbon_cell);
}

void RoadBuilder::stand(Object& object, double right, double left, double bottom, double top,
                        const TextureArea& area) const {
  const auto length = static_cast<float>(stretch_length), height = static_cast<float>(top - bottom);
  const auto x = [](double value) { return static_cast<float>(value); };
  add_rectangle(object.mesh, {0, x(right), x(top)}, {length, 0, 0}, {0, 0, -height}, area, ribbon_cell);
  add_rectangle(object.mesh, {length, x(left), x(top)}, {-length, 0, 0}, {0, 0, -height}, area, ribbon_cell);
  if (left - right > 0.01) lie(object, right, left, top, area);
}

void RoadBuilder::stretch(int number) {
  const double from = number * stretch_length;
  Random random = random_.fork(2).fork(static_cast<std::uint64_t>(number + 1000));
  Object& road = add("road", Isometry3d::Identity());
  lie(road, -profile_.edge, profile_.edge, 0.0, any_of(stock_.asphalt, random));
  bend(road, from);
  Object& ground = add("grass", Isometry3d::Identity());
  for (const double side : {-1.0, 1.0})
    for (int strip = 0; strip < 2; ++strip) {
      const double near = profile_.verge + 20.0 * strip, far = near + 20.0;
      lie(ground, std::min(side * near, side * far), std::max(side * near, side * far), -0.01,
          any_of(stock_.grass, random));
    }
  bend(ground, from);
  if (plan_.kind == RoadKind::street)
    street_stretch(from, random.fork(1));
  else
    motorway_stretch(number, from, random.fork(1));
}

void RoadBuilder::street_stretch(double from, Random random) {
  Object& pavement = add("pavement", Isometry3d::Identity());
  for (const double side : {-1.0, 1.0}) {
    const double kerb = side * profile_.edge, verge = side * profile_.verge;
    lie(pavement, std::min(kerb, verge), std::max(kerb, verge), 0.12, any_of(stock_.paving, random));
    stand(pavement, kerb, kerb, 0.0, 0.12, stock_.metal);
  }
  bend(pavement, from);
  for (const double side : {-1.0, 1.0}) {
    houses(from, side, random.fork(side > 0 ? 1 : 2));
    for (double x = from + 3.0; x < from + stretch_length; x += 6.5) {
      const double moved = random.uniform(-0.5, 0.5);
      if (random.uniform() < 0.6) car(x + moved, side * 4.65, side < 0, random.fork(3));
    }
    const double near_tree = from + random.uniform(2.0, 18.0), far_tree = from + random.uniform(2.0, 18.0);
    const double plate = from + random.uniform(2.0, 18.0), far = random.uniform(26.0, 40.0);
    if (random.uniform() < 0.7) tree(near_tree, side * 6.6, random.fork(4));
    if (random.uniform() < 0.4) tree(far_tree, side * far, random.fork(5));
    if (random.uniform() < 0.3) sign(plate, side * 6.2, 0.6, 0.6, 2.1, random.fork(6));
  }
  lamp(from + 9.0, 1.0);
  lamp(from + 19.0, -1.0);
}

void RoadBuilder::houses(double from, double side, Random random) {
  const double width = random.uniform(9.0, 17.0), setback = random.uniform(0.5, 3.5);
  const double x = from + stretch_length / 2 + random.uniform(-1.0, 1.0), left = side * (profile_.verge + setback);
  const double turn = side > 0 ? 0.0 : 2.0 * quarter_turn;
  const std::uint32_t storeys = 1 + random.below(3);
  const auto pick = random.below(4);
  if (random.uniform() < 0.88) {
    Object& house = add("house", course_.frame(x, left) * Eigen::AngleAxisd(turn, Vector3d::UnitZ()));
    BoxSkin skin = all_sides(any_of(stock_.plaster, random));
    skin[front] = stock_.facades[(pick * 3 + storeys - 1) % stock_.facades.size()];
    add_box(house.mesh, box(-width / 2, 0.0, 0.0, width / 2, 10.0, 4.0 + 3.0 * storeys), skin, 3.0F);
  }
  // A hedge along the front garden, with a gate.
  const Isometry3d T_world_hedge = course_.frame(x, side * (profile_.verge + 0.3));
  const double height = random.uniform(0.5, 1.4);
  for (const double end : {-1.0, 1.0}) {
    Object& hedge = add("hedge", T_world_hedge * Eigen::Translation3d(end * 5.2, 0, 0));
    add_box(hedge.mesh, box(-3.9, -0.25, 0.0, 3.9, 0.25, height), all_sides(any_of(stock_.foliage, random)), 2.0F);
  }
}

void RoadBuilder::motorway_stretch(int number, double from, Random random) {
  Object& rail = add("guard rail", Isometry3d::Identity());
  for (const double offset : {-13.3, -0.4, 0.4, 13.3}) {
    stand(rail, offset - 0.03, offset + 0.03, 0.45, 0.78, stock_.metal);
    for (double x = 1.0; x < stretch_length; x += 4.0)
      add_box(rail.mesh, box(x - 0.06, offset - 0.06, 0.0, x + 0.06, offset + 0.06, 0.7), all_sides(stock_.dark), 1.0F,
              false);
  }
  bend(rail, from);
  // Noise barriers are a hundred metres long.
  const int block = static_cast<int>(std::floor(number / 5.0));
  for (const double side : {-1.0, 1.0}) {
    const bool barrier = random_.fork(side > 0 ? 7 : 8).fork(static_cast<std::uint64_t>(block + 1000)).uniform() < 0.25;
    if (barrier) {
      Object& wall = add("wall", Isometry3d::Identity());
      stand(wall, side * 16.0 - 0.1, side * 16.0 + 0.1, 0.0, 3.2, any_of(stock_.plaster, random));
      bend(wall, from);
    }
    for (int i = 0; i < 3; ++i) {
      const double x = from + random.uniform(0.0, stretch_length), left = side * random.uniform(19.0, 48.0);
      if (random.uniform() < 0.5) tree(x, left, random.fork(10 + i));
      random.next();
    }
    if (random.uniform() < 0.2) sign(from + 5.0, side * 14.2, 0.9, 0.6, 1.6, random.fork(20));
    if (random.uniform() < 0.08) sign(from + 12.0, side * 14.9, 3.6, 2.4, 2.2, random.fork(21));
    Object& post = add("post", course_.frame(from + 15.0, side * 13.0));
    add_box(post.mesh, box(-0.05, -0.06, 0.0, 0.05, 0.06, 1.0), all_sides(any_of(stock_.signs, random)), 1.0F, false);
  }
  if (random.uniform() < 0.06) bridge(from + stretch_length / 2);
}

void RoadBuilder::car(double x, double left, bool onwards, Random random) {
  const double turn = (onwards ? 0.0 : 2.0 * quarter_turn) + random.uniform(-0.02, 0.02);
  Object& object = add("car", course_.frame(x, left) * Eigen::AngleAxisd(turn, Vector3d::UnitZ()));
  object.mesh = stock_.cars[random.below(static_cast<std::uint32_t>(stock_.cars.size()))];
}

void RoadBuilder::tree(double x, double left, Random random) {
  Object& object = add("tree", course_.frame(x, left));
  const auto trunk = static_cast<float>(random.uniform(1.8, 2.8)),
             radius = static_cast<float>(random.uniform(1.2, 2.4));
  const auto height = static_cast<float>(random.uniform(2.5, 6.0));
  add_cylinder(object.mesh, Vector3f::Zero(), 0.2F, 0.15F, trunk + 0.4F, stock_.wood, stock_.wood, 8);
  const TextureArea& leaves = any_of(stock_.foliage, random);
  const float widths[] = {0.45F, 1.0F, 0.8F, 0.1F}, steps[] = {0.25F, 0.4F, 0.35F};
  float base = trunk;
  for (int i = 0; i < 3; ++i) {
    add_cylinder(object.mesh, {0, 0, base}, radius * widths[i], radius * widths[i + 1], height * steps[i], leaves,
                 leaves, 10, false);
    base += height * steps[i];
  }
}

void RoadBuilder::lamp(double x, double side) {
  Object& object = add("lamp", course_.frame(x, side * 6.1));
  add_cylinder(object.mesh, Vector3f::Zero(), 0.09F, 0.06F, 7.0F, stock_.metal, stock_.metal, 8);
  const auto inwards = static_cast<float>(-side);
  add_bar(object.mesh, {{0, 0, 6.9F}, {0, 0.6F * inwards, 7.2F}, {0, 1.6F * inwards, 7.25F}}, 0.06F, stock_.metal);
}

void RoadBuilder::sign(double x, double left, double width, double height, double base, Random random) {
  Object& object = add("sign", course_.frame(x, left));
  BoxSkin skin = all_sides(stock_.metal);
  skin[BoxSide::left] = any_of(stock_.signs, random);
  add_box(object.mesh, box(-0.02, -width / 2, base, 0.02, width / 2, base + height), skin, 2.0F);
  add_cylinder(object.mesh, {0.08F, 0, 0}, 0.04F, 0.04F, static_cast<float>(base + height), stock_.metal, stock_.metal,
               6, false);
}

void RoadBuilder::bridge(double x) {
  Object& object = add("bridge", course_.frame(x));
  const BoxSkin concrete = all_sides(stock_.plaster[0]);
  add_box(object.mesh, box(-4.0, -30.0, 5.2, 4.0, 30.0, 6.8), concrete, 4.0F);
  for (const double side : {-15.0, 15.0})
    add_box(object.mesh, box(-0.6, side - 0.6, 0.0, 0.6, side + 0.6, 5.2), concrete, 2.0F);
}

}  // namespace holdfast::simulation
