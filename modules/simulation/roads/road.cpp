// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <sstream>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/simulation/pictures.hpp"
#include "road_builder.hpp"
#include "rooms/measures.hpp"

namespace holdfast::simulation {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {
constexpr double behind = 40.0, ahead = 420.0;  // of the camera: where the road begins and ends [m]
constexpr double farthest_drive = 20000.0;      // [m]
constexpr float backdrop = 1500.0F;             // distance of hills and sky from the road [m]
constexpr double sun_distance = 1e5;            // [m]

const Vector3d towards_sun = Vector3d(-0.45, 0.4, 0.8).normalized();

/// One lane of traffic.
struct Lane {
  double offset;   ///< to the left of the centre line [m]
  double speed;    ///< [m/s], negative against the camera
  double spacing;  ///< mean distance of vehicles [m]
  double lorries;  ///< their share
};
}  // namespace

void RoadBuilder::surroundings(double from, double to) {
  const auto begin = static_cast<float>(from) - backdrop, end = static_cast<float>(to) + backdrop;
  const float length = end - begin, width = 2.0F * backdrop;
  Object& fields = add("ground", Isometry3d::Identity());
  const TextureArea meadow = world_.add_texture(pictures::grass({1024, 1024}, random_.fork(3)));
  add_rectangle(fields.mesh, {begin, backdrop, -0.15F}, {length, 0, 0}, {0, -width, 0}, meadow, 200.0F);

  // One picture runs along the left side, across the end and back along the right side.
  constexpr float low = -12.0F, high = 1150.0F;
  const float around = 2.0F * length + width;
  const float metres_per_texel = std::max(2.5F, around / 16000.0F);
  const auto texels_of = [&](float metres) { return static_cast<int>(metres / metres_per_texel); };
  const TextureArea all = world_.add_texture(
      pictures::panorama({texels_of(around), texels_of(high - low)}, texels_of(high), random_.fork(4)));
  Object& sky = add("background", Isometry3d::Identity());
  const Vector3f down(0, 0, low - high);
  const auto wall = [&](const Vector3f& origin, const Vector3f& right, float start) {
    const float share = right.norm() / around;
    add_rectangle(sky.mesh, origin, right, down,
                  {all.texture, all.u + all.width * start / around, all.v, all.width * share, all.height}, 400.0F);
  };
  wall({begin, backdrop, high}, {length, 0, 0}, 0.0F);
  wall({end, backdrop, high}, {0, -width, 0}, length);
  wall({end, -backdrop, high}, {-length, 0, 0}, length + width);
  add_rectangle(sky.mesh, {begin, -backdrop, high}, {length, 0, 0}, {0, width, 0},
                {all.texture, all.u, all.v, 0.01F * all.width, 0.01F * all.height}, 400.0F);  // overhead
  for (Vertex& vertex : sky.mesh.vertices) vertex.normal = towards_sun.cast<float>();         // no shading on the sky
}

void RoadBuilder::vehicle(const Mesh& mesh, const std::string& class_name,
                          std::function<Isometry3d(double)> T_world_vehicle) {
  Object& object = add(class_name, T_world_vehicle(0.0));
  object.mesh = mesh;
  object.motion = std::move(T_world_vehicle);
}

void RoadBuilder::traffic() {
  if (plan_.traffic <= 0.0) return;
  const double speed = plan_.mean_speed(), own = course_.lane();
  Random random = random_.fork(5);
  const auto any_vehicle = [&](double lorries, auto&& motion) {
    const bool lorry = random.uniform() < lorries;
    const std::vector<Mesh>& meshes = lorry ? stock_.lorries : stock_.cars;
    const Mesh mesh = meshes[random.below(static_cast<std::uint32_t>(meshes.size()))];
    vehicle(mesh, lorry ? "lorry" : "car", motion);
  };

  // In the camera's lane vehicles keep their distance to it, more or less.
  const bool street = plan_.kind == RoadKind::street;
  double gap = random.uniform(0.6, 1.2) * speed + 6.0;
  while (gap < ahead) {
    const double period = random.uniform(8.0, 16.0), phase = random.uniform(0.0, 6.28);
    any_vehicle(street ? 0.1 : 0.4, [course = course_, gap, period, phase, own](double time) {
      const double swing = 2.5 * std::sin(6.283185307179586 * time / period + phase);
      return course.frame(course.driven(time) + gap + swing, own);
    });
    gap += random.uniform(14.0, 3.5 * speed + 14.0) / plan_.traffic;
  }

  // In the others they have a speed of their own. One that falls behind the camera begins again far ahead.
  std::vector<Lane> lanes;
  if (street) {
    lanes = {{-own, -speed * random.uniform(0.9, 1.2), 55.0, 0.1}};
  } else {
    lanes = {{-road_profile(plan_.kind).lanes[0], speed * random.uniform(1.15, 1.3), 60.0, 0.0}};
    lanes.push_back({road_profile(plan_.kind).lanes[0], -speed * random.uniform(1.15, 1.3), 60.0, 0.0});
    lanes.push_back({road_profile(plan_.kind).lanes[1], -speed * random.uniform(0.85, 0.95), 50.0, 0.4});
  }
  constexpr double range = ahead + behind - 40.0;  // the last vehicle is still on the road
  for (const Lane& lane : lanes) {
    const auto count = static_cast<int>(std::lround(range * plan_.traffic / lane.spacing));
    for (int i = 0; i < count; ++i) {
      const double start = (i + random.uniform(-0.2, 0.2)) * range / count;
      any_vehicle(lane.lorries, [course = course_, start, lane](double time) {
        const double camera = course.driven(time), distance = start + lane.speed * time - camera;
        const double x = camera - behind + 20.0 + distance - range * std::floor(distance / range);
        const Isometry3d pose = course.frame(x, lane.offset);
        return lane.speed > 0.0 ? pose : pose * Eigen::AngleAxisd(2.0 * quarter_turn, Vector3d::UnitZ());
      });
    }
  }
}

Room furnish_road(const RoadPlan& plan, double duration, std::uint64_t seed) {
  const double drive = RoadCourse(plan, seed).driven(duration);
  if (!(drive <= farthest_drive)) {
    std::ostringstream text;
    text << "a drive of " << duration << " s at " << plan.mean_speed() << " m/s is " << drive
         << " m long; expected at most " << farthest_drive << " m";
    throw ConfigurationError(SourceLocation{}, text.str());
  }
  Room room;
  RoadBuilder builder(room.world, plan, seed);
  const int first = -static_cast<int>(behind / stretch_length);
  const int last = static_cast<int>(std::ceil((drive + ahead) / stretch_length));
  for (int number = first; number < last; ++number) builder.stretch(number);
  builder.surroundings(first * stretch_length, last * stretch_length);
  builder.traffic();
  room.world.ambient = 0.5F;
  room.world.lamps.push_back({(sun_distance * towards_sun).cast<float>(),
                              static_cast<float>(0.62 * (0.5 * sun_distance * sun_distance + 0.5))});

  Stage& stage = room.stage;
  stage.walls.setEmpty();
  for (double x = -behind; x < drive + ahead; x += stretch_length)
    for (const double side : {-60.0, 60.0}) stage.walls.extend(builder.course().frame(x, side).translation());
  stage.walls.extend(Vector3d(0, 0, 40.0));
  stage.free_floor = {Eigen::Vector2d(-behind, -10.0), Eigen::Vector2d(drive + ahead, 10.0)};
  return room;
}

}  // namespace holdfast::simulation
