// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "script_builder.hpp"

namespace holdfast::simulation {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {
/// Both palms against the sides of a thing, not too far from its near face, fingers forward and a little down.
Grips side_grips(const Vector3d& centre, const Vector3d& left, const Vector3d& forward, double half_width,
                 double half_depth) {
  const double nearer = std::max(std::min(0.05, 0.3 * half_depth), half_depth - 0.18);
  Grips grips;
  for (const Side side : {Side::left, Side::right}) {
    const auto i = static_cast<std::size_t>(side);
    grips.points[i] = centre + sign(side) * half_width * left - nearer * forward;
    grips.palms[i] = -sign(side) * left;
    grips.fingers[i] = forward - 0.45 * Vector3d::UnitZ();
  }
  return grips;
}

/// Palms on a thing's rear edge, or against its back where the edge is out of reach; in a frame that faces `forward`.
Grips push_grips(const Vector3d& back, const Vector3d& left, const Vector3d& forward, double half_width, double top) {
  const bool on_edge = top > 0.7 && top < 1.2;
  Grips grips;
  for (const Side side : {Side::left, Side::right}) {
    const auto i = static_cast<std::size_t>(side);
    grips.points[i] = back + sign(side) * std::min(0.15, 0.8 * half_width) * left;
    grips.points[i].z() = on_edge ? top : std::min(0.95, 0.85 * top);
    if (on_edge) grips.points[i] += 0.03 * forward;
    grips.palms[i] = on_edge ? Vector3d(0.25 * forward - Vector3d::UnitZ()) : forward;
    grips.fingers[i] =
        on_edge ? Vector3d(forward - 0.2 * sign(side) * left) : Vector3d(Vector3d::UnitZ() - 0.3 * sign(side) * left);
  }
  return grips;
}
}  // namespace

ScriptBuilder::Seen ScriptBuilder::see(const Isometry3d& T_world_thing, const Eigen::AlignedBox3d& extents,
                                       double heading) const {
  const Eigen::Matrix3d to_thing = T_world_thing.linear().transpose() * turned(heading).linear();
  Seen seen;
  seen.centre = extents.center();
  seen.left = to_thing.col(0);
  seen.forward = -to_thing.col(1);
  const Vector3d half = 0.5 * extents.sizes();
  seen.half_width = seen.left.cwiseAbs().dot(half);
  seen.half_depth = seen.forward.cwiseAbs().dot(half);
  return seen;
}

std::optional<Movement::Bend> ScriptBuilder::bend_to_reach(const Grips& grips, const Isometry3d& T_person_thing,
                                                           bool knees) const {
  const Skeleton& skeleton = movement_.skeleton();
  const double arm_length = skeleton.length(Bone::left_upper_arm) + skeleton.length(Bone::left_forearm);
  const auto bend = [&](double share) {
    return Movement::Bend{.window = {},
                          .bow = 85.0 * degrees * share,
                          .drop = knees ? 0.3 * skeleton.physique().height * share * share : 0.0,
                          .back = knees ? 0.16 * share : 0.0};
  };
  const auto reaches = [&](double share) {
    const Movement::Bend tried = bend(share);
    for (const Side side : {Side::left, Side::right}) {
      const auto i = static_cast<std::size_t>(side);
      const HandPose hand =
          hand_on(skeleton, side, T_person_thing * grips.points[i], T_person_thing.linear() * grips.palms[i],
                  T_person_thing.linear() * grips.fingers[i]);
      const Vector3d shoulder = movement_.bent_shoulder(side, tried.bow, tried.drop, tried.back);
      if ((hand.wrist - shoulder).norm() > 0.95 * arm_length) return false;
    }
    return true;
  };
  for (double share = 0.08; share <= 1.0; share += 0.02)
    if (reaches(share)) return bend(share);
  return std::nullopt;
}

std::optional<ScriptBuilder::Standpoint> ScriptBuilder::place_before(const Isometry3d& T_world_thing,
                                                                     const std::string& name, double heading,
                                                                     const Grips& grips) const {
  const Seen seen = see(T_world_thing, things_.at(name).extents, heading);
  const Vector2d centre = (T_world_thing * seen.centre).head<2>();
  for (const double gap : {0.36, 0.42, 0.48, 0.54, 0.6, 0.66, 0.72, 0.3, 0.25}) {
    const Standpoint place{centre - (seen.half_depth + gap) * direction_of(heading), heading};
    const Isometry3d T_person_thing =
        (Eigen::Translation3d(flat(place.position)) * turned(heading)).inverse() * T_world_thing;
    if (free_to_stand(place.position, name) && bend_to_reach(grips, T_person_thing, true)) return place;
  }
  return std::nullopt;
}

void ScriptBuilder::push(const Push& action) {
  check_route(action.to, "push '" + action.thing + "'");
  check_positive(action.speed, "speed of pushing");
  claim(action.thing, Handling::push);
  std::vector<Vector2d> places{rest(action.thing).translation().head<2>()};
  for (const Vector2d& place : action.to)
    if ((place - places.back()).norm() >= 0.05) places.push_back(place);
  // When the plan repeats, the thing may be where it belongs.
  const bool moved = std::any_of(movement_.holds.begin(), movement_.holds.end(),
                                 [&](const Movement::Hold& hold) { return hold.thing == action.thing; });
  if (places.size() < 2 && !moved)
    refuse("is to push '" + action.thing + "' to where it stands; expected a place at least 0.05 m away");
  for (const std::vector<Vector2d>& leg : Route::legs(places)) push_along(action, leg);
}

Movement::Bend ScriptBuilder::step_behind(const std::string& name, const Standpoint& stand, const Obstacle& around,
                                          const Isometry3d& T_world_thing, const Grips& grips) {
  go({stand.position}, approaching, around);
  movement_.turn(stand.heading);
  const Isometry3d T_person_thing =
      (Eigen::Translation3d(flat(stand.position)) * turned(stand.heading)).inverse() * T_world_thing;
  const std::optional<Movement::Bend> bend = bend_to_reach(grips, T_person_thing, false);
  if (!bend) refuse("cannot reach '" + name + "' to push it; it is too low or too high");
  return *bend;
}

void ScriptBuilder::push_along(const Push& action, const std::vector<Vector2d>& places) {
  const ThingPlace& place = things_.at(action.thing);
  const Isometry3d T_world_thing = rest(action.thing);
  const Vector2d& start = places[0];
  const double heading = heading_of(places[1] - start);
  // A chair is swivelled until its back comes into the hands; other things are pushed as they stand.
  const double swivel =
      place.class_name == "chair" ? std::remainder(heading - yaw_of(T_world_thing), 2.0 * std::numbers::pi) : 0.0;
  const auto swivelled_by = [T_world_thing](double angle) -> Isometry3d {
    return Eigen::Translation3d(T_world_thing.translation()) * turned(angle) * Isometry3d(T_world_thing.linear());
  };
  const Isometry3d swivelled = swivelled_by(swivel);
  const Seen seen = see(swivelled, place.extents, heading);
  const double rear = seen.half_depth - seen.forward.dot(seen.centre);
  const double gap = rear + 0.32 * movement_.skeleton().physique().height;
  const Vector3d back = seen.centre - seen.forward * (seen.half_depth);
  const Grips grips = push_grips(back, seen.left, seen.forward, seen.half_width, place.extents.max().z());
  const Standpoint stand{start - gap * direction_of(heading), heading};
  const Obstacle around{start, seen.half_depth + 0.4};
  Movement::Bend bend = step_behind(action.thing, stand, around, swivelled, grips);
  const double touch = movement_.end(), grip = touch + 0.8 + 0.5 * std::abs(swivel);
  movement_.wait(grip - touch);
  std::vector<Vector2d> points{stand.position};
  points.insert(points.end(), places.begin(), places.end());
  const Route route(points, 1.0);
  const double length = route.length() - gap;
  const double turned_off = movement_.last().heading - route.heading(0.0);
  // The thing goes ahead on the same line; the person faces it.
  const auto pose = [=](double distance) {
    const Vector2d person = route.position(distance), ahead = route.position(distance + gap) - person;
    const double along = route.heading(distance + 0.5 * gap);
    const double facing = along + std::remainder(heading_of(ahead) - along, 2.0 * std::numbers::pi);
    return simulation::Stance{person, facing + turned_off, {}};
  };
  const Travel travel(route, length, action.speed);
  movement_.walk(travel, length, action.speed, pose);
  const double arrived = movement_.end();
  movement_.wait(0.7);
  const Window window{grip - 0.8, grip, arrived + 0.1, arrived + 0.7};
  bend.window = window;
  movement_.bends.push_back(bend);
  movement_.holds.push_back({window, action.thing, grips});

  const auto at = [=, rotation = Eigen::Matrix3d(swivelled.linear()),
                   height = T_world_thing.translation().z()](double distance) {
    Isometry3d result = turned(pose(distance).heading - turned_off - heading) * Isometry3d(rotation);
    result.translation() << route.position(distance + gap), height;
    return result;
  };
  Isometry3d rest_after = at(length);
  rest_after.translation() << places.back(), T_world_thing.translation().z();
  ThingTrack& track = movement_.things.at(action.thing);
  const auto swivelling = [=](const Movement&, double time) {
    return swivelled_by(swivel * ease((time - touch) / (grip - touch)));
  };
  if (swivel != 0.0) track.move(touch, grip, swivelling, swivelled);
  const auto pushed = [=](const Movement&, double time) { return at(travel.distance(time - grip)); };
  track.move(grip, arrived, pushed, rest_after);
  behind_ = Obstacle{places.back(), seen.half_depth + 0.4};
}

ScriptBuilder::Load ScriptBuilder::choose_side(const Carry& action) {
  const ThingPlace& place = things_.at(action.thing);
  Load load;
  load.T_world_thing = rest(action.thing);
  std::optional<Standpoint> stand;
  double nearest = 0.0;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double heading = yaw_of(load.T_world_thing) + 0.5 * std::numbers::pi * quarter;
    const Seen side = see(load.T_world_thing, place.extents, heading);
    if (2.0 * side.half_width > widest_load) continue;
    const Grips tried = side_grips(side.centre, side.left, side.forward, side.half_width, side.half_depth);
    const std::optional<Standpoint> found = place_before(load.T_world_thing, action.thing, heading, tried);
    if (!found) continue;
    const double distance = (found->position - movement_.last().position).norm();
    if (stand && distance >= nearest) continue;
    stand = found, nearest = distance, load.grips = tried, load.seen = side;
  }
  if (!stand)
    refuse("cannot lift '" + action.thing + "': from none of its sides is there a free place within reach of it");
  load.stand = *stand;
  // Before the chest, with the orientation relative to the body that it has now.
  const double height = movement_.skeleton().physique().height;
  load.T_person_held.linear() = turned(-stand->heading).linear() * load.T_world_thing.linear();
  load.T_person_held.translation() = Vector3d(0, -load.seen.half_depth - 0.115 * height, 0.6 * height) -
                                     load.T_person_held.linear() * load.seen.centre;
  return load;
}

Movement::Bend ScriptBuilder::bend_to(const std::string& name, const Grips& grips, const Isometry3d& T_world_rest) {
  const Stance& here = movement_.last();
  const Isometry3d T_world_person = Eigen::Translation3d(flat(here.position)) * turned(here.heading);
  const std::optional<Movement::Bend> bend = bend_to_reach(grips, T_world_person.inverse() * T_world_rest, true);
  if (!bend) refuse("cannot reach '" + name + "' where it lies or is to lie");
  return *bend;
}

Isometry3d ScriptBuilder::carry_to(const Carry& action, const Load& load) {
  // In the direction of arrival if there is room to stand, else from another side.
  const double arrival_direction_limit = 0.05;
  std::vector<Vector2d> points = action.to;
  const Vector2d last = points.empty() ? movement_.last().position : points.back();
  const Vector2d target = action.put_at.head<2>();
  const double arriving =
      (target - last).norm() > arrival_direction_limit ? heading_of(target - last) : load.stand.heading;
  std::optional<Standpoint> destination;
  Isometry3d T_world_put;
  for (const double aside : {0.0, 0.25, -0.25, 0.5, -0.5, 0.75, -0.75, 1.0}) {
    const double heading = arriving + aside * std::numbers::pi;
    T_world_put = turned(heading) * Isometry3d(load.T_person_held.linear());
    T_world_put.translation() = action.put_at;
    destination = place_before(T_world_put, action.thing, heading, load.grips);
    if (destination) break;
  }
  if (!destination) refuse("cannot put down '" + action.thing + "': there is no free place within reach of put_at");
  if (!points.empty() && (destination->position - last).dot(direction_of(arriving)) < 0.1)
    points.back() = destination->position;
  else
    points.push_back(destination->position);
  go(points, action.speed, std::nullopt);
  movement_.turn(destination->heading);
  return T_world_put;
}

void ScriptBuilder::carry(const Carry& action) {
  check_positive(action.speed, "speed of carrying");
  claim(action.thing, Handling::carry);
  check_put_down(action);
  const Load load = choose_side(action);
  const Isometry3d T_world_thing = load.T_world_thing;
  const double radius = std::max(load.seen.half_width, load.seen.half_depth) + 0.25;
  go({load.stand.position}, approaching, Obstacle{(T_world_thing * load.seen.centre).head<2>(), radius});
  movement_.turn(load.stand.heading);
  const auto held = [T_person_held = load.T_person_held](const Movement& movement, double time) {
    const double bob = movement.pelvis_height(time) - movement.standing_height();
    return movement.root(time) * Eigen::Translation3d(0, 0, bob) * T_person_held;
  };
  // Between where it rests and where it is held: first mostly up, and without the knees in the way.
  const auto between = [held](const Movement& movement, const Isometry3d& rest, double time, double share) {
    Isometry3d result = held(movement, time);
    const Vector3d low = rest.translation(), high = result.translation();
    const double across = ease(1.5 * share - 0.5), up = ease(share);
    result.translation() = low + Vector3d(across, across, up).cwiseProduct(high - low);
    return result;
  };

  Movement::Bend bend = bend_to(action.thing, load.grips, T_world_thing);
  const double pace = 0.75 + 0.6 * bend.bow / (85.0 * degrees), lower = movement_.end(), grip = lower + pace,
               lift = grip + 0.1, lifted = lift + 1.2 * pace;
  movement_.wait(lifted - lower + 0.25 * pace);
  // The body follows the load, so that the arms need not stretch.
  bend.window = {lower, grip, lift + 0.15 * pace, lifted + 0.2 * pace};
  movement_.bends.push_back(bend);

  const Isometry3d T_world_put = carry_to(action, load);
  bend = bend_to(action.thing, load.grips, T_world_put);
  const double slow = 0.75 + 0.6 * bend.bow / (85.0 * degrees), sink = movement_.end() + 0.25 * slow,
               put = sink + 1.2 * slow, release = put + 0.1, upright = release + slow;
  movement_.wait(upright - movement_.end());
  bend.window = {sink - 0.2 * slow, put - 0.15 * slow, release, upright};
  movement_.bends.push_back(bend);
  movement_.holds.push_back({{lower, grip, release, upright}, action.thing, load.grips});
  const auto lifting = [=](const Movement& movement, double time) {
    return between(movement, T_world_thing, time, (time - lift) / (lifted - lift));
  };
  const auto lowering = [=](const Movement& movement, double time) {
    return between(movement, T_world_put, time, (put - time) / (put - sink));
  };
  ThingTrack& track = movement_.things.at(action.thing);
  track.move(lift, lifted, lifting, T_world_thing);
  track.move(lifted, sink, held, T_world_thing);
  track.move(sink, put, lowering, T_world_put);
  behind_ = Obstacle{action.put_at.head<2>(), radius};
}

}  // namespace holdfast::simulation
