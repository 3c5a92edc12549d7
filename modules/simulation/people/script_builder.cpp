// SPDX-License-Identifier: BSD-3-Clause
#include "script_builder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace holdfast::simulation {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

void ScriptBuilder::play(const Action& action, std::size_t number) {
  action_number_ = number;
  if (const auto* walking = std::get_if<Walk>(&action)) walk(*walking);
  if (const auto* standing = std::get_if<Stand>(&action)) stand(*standing);
  if (const auto* sitting = std::get_if<Sit>(&action)) sit(*sitting);
  if (const auto* pushing = std::get_if<Push>(&action)) push(*pushing);
  if (const auto* carrying = std::get_if<Carry>(&action)) carry(*carrying);
}

void ScriptBuilder::return_to_start() {
  if ((movement_.last().position - plan_.at).norm() > 0.05) go({plan_.at}, approaching, behind_);
}

void ScriptBuilder::go(std::vector<Vector2d> points, double speed, const std::optional<Obstacle>& obstacle) {
  points.insert(points.begin(), movement_.last().position);
  behind_.reset();
  if (obstacle) {
    const Vector2d from = points[0], span = points[1] - from, to_centre = obstacle->centre - from;
    const double along = span.squaredNorm() > 0 ? to_centre.dot(span) / span.squaredNorm() : 0.0;
    const Vector2d nearest = from + std::clamp(along, 0.0, 1.0) * span;
    const double limit = std::min(
        {obstacle->radius, 0.9 * (points[1] - obstacle->centre).norm(), 0.9 * (from - obstacle->centre).norm()});
    if (along > 0.0 && along < 1.0 && (nearest - obstacle->centre).norm() < limit) {
      const Vector2d left = Vector2d(-span.y(), span.x()).normalized();
      const double side = left.dot(nearest - obstacle->centre) >= 0 ? 1.0 : -1.0;
      points.insert(points.begin() + 1, obstacle->centre + side * (obstacle->radius + 0.1) * left);
    }
  }
  for (const auto& leg : Route::legs(points)) {
    const Route route(leg);
    movement_.turn(route.heading(0.0));
    const double base = movement_.last().heading, turned_off = base - route.heading(0.0);
    movement_.walk(Travel(route, route.length(), speed), route.length(), speed, [=](double distance) {
      return simulation::Stance{route.position(distance), route.heading(distance) + turned_off, {}};
    });
  }
}

void ScriptBuilder::walk(const Walk& action) {
  check_route(action.to, "walk");
  check_positive(action.speed, "walking speed");
  go(action.to, action.speed, behind_);
}

void ScriptBuilder::stand(const Stand& action) {
  check_positive(action.duration, "time to stand");
  if (action.facing && (*action.facing - movement_.last().position).norm() > 1e-6)
    movement_.turn(heading_of(*action.facing - movement_.last().position));
  if (action.gesture) {
    const double start = movement_.end(), change = std::min(0.8, 0.4 * action.duration);
    movement_.gestures.push_back({start, start + change, start + action.duration - change, start + action.duration});
  }
  movement_.wait(action.duration);
}

void ScriptBuilder::sit(const Sit& action) {
  ThingPlace& chair = thing(action.on, "sit on");
  if (chair.class_name != "chair")
    refuse("wants to sit on '" + action.on + "', which is a " + chair.class_name + "; expected a chair");
  if (const std::string above = thing_on(action.on); !above.empty())
    refuse("wants to sit on '" + action.on + "', on which '" + above + "' stands; let it be taken away first");
  check_positive(action.duration, "time to sit");
  chair.used_by = plan_.name;
  const Isometry3d T_world_chair = rest(action.on);
  const double yaw = yaw_of(T_world_chair), height = movement_.skeleton().physique().height;
  const Vector2d seat = T_world_chair.translation().head<2>(), ahead = 0.235 * height * direction_of(yaw);
  go({seat + ahead}, approaching, Obstacle{seat, 0.6});
  movement_.turn(yaw);
  movement_.wait(0.15);
  const double down = movement_.end(), seated = down + 1.7, rising = seated + action.duration, up = rising + 1.6;
  const Window window{down, seated, rising, up};
  // The flesh of the thighs is between the hip joints and the seat.
  const double flesh = 0.054 * height * movement_.skeleton().physique().girth;
  movement_.seats.push_back(
      {.window = window,
       .drop = movement_.standing_height() - T_world_chair.translation().z() - seat_height - flesh,
       .lean = -0.06,
       .table = table_before(T_world_chair)});
  const double change = std::min(0.8, 0.4 * action.duration);
  if (action.gesture) movement_.gestures.push_back({seated, seated + change, rising - change, rising});
  movement_.shift(window, -ahead);
  behind_ = Obstacle{seat, 0.6};
}

double ScriptBuilder::table_before(const Isometry3d& T_world_chair) const {
  for (const auto& [name, place] : things_) {
    if (place.class_name != "desk" && place.class_name != "table") continue;
    const Vector3d before = place.T_world_thing.inverse() * (T_world_chair * Vector3d(0, -0.45, 0));
    const double top = place.T_world_thing.translation().z() + place.extents.max().z();
    const bool above = (before - place.extents.min()).head<2>().minCoeff() > 0 &&
                       (place.extents.max() - before).head<2>().minCoeff() > 0;
    if (above && top > 0.6 && top < 0.85) return top;
  }
  return 0.0;
}

}  // namespace holdfast::simulation
