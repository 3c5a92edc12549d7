// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/person_script.hpp"

#include <utility>

#include "holdfast/core/error.hpp"
#include "script_builder.hpp"

namespace holdfast::simulation {

using Eigen::Vector2d;

namespace {

/// Where the first action leads, to look there at first.
Vector2d first_aim(const PersonPlan& plan, const ThingPlaces& things) {
  if (plan.facing) return *plan.facing;
  const auto place = [&](const std::string& name) {
    const auto found = things.find(name);
    return found != things.end() ? Vector2d(found->second.T_world_thing.translation().head<2>()) : plan.at;
  };
  for (const Action& action : plan.actions) {
    if (const auto* walk = std::get_if<Walk>(&action); walk != nullptr && !walk->to.empty()) return walk->to.front();
    if (const auto* stand = std::get_if<Stand>(&action); stand != nullptr && stand->facing) return *stand->facing;
    if (const auto* sit = std::get_if<Sit>(&action)) return place(sit->on);
    if (const auto* push = std::get_if<Push>(&action)) return place(push->thing);
    if (const auto* carry = std::get_if<Carry>(&action)) return place(carry->thing);
  }
  return plan.at;
}

}  // namespace

PersonScript::PersonScript(const Skeleton& skeleton, const PersonPlan& plan, ThingPlaces& things,
                           const Eigen::AlignedBox3d& walls, double duration, Random style) {
  const Vector2d aim = first_aim(plan, things) - plan.at;
  const double heading = aim.norm() > 1e-6 ? heading_of(aim) : 0.0;
  auto movement = std::make_shared<Movement>(skeleton, Style(style), plan.at, heading);
  ScriptBuilder builder(*movement, plan, things, walls);
  movement->wait(plan.start);
  do {
    const double before = movement->end();
    for (std::size_t i = 0; i < plan.actions.size(); ++i) builder.play(plan.actions[i], i);
    if (!plan.repeat) break;
    builder.return_to_start();
    if (movement->end() <= before) break;  // nothing to do, or to go to where one is
  } while (movement->end() < duration);
  movement->finish(duration);
  movement_ = std::move(movement);
}

Eigen::Isometry3d PersonScript::T_world_person(double time) const { return movement_->root(time); }
Posture PersonScript::posture(double time) const { return movement_->posture(time); }
FootPose PersonScript::foot(Side side, double time) const { return movement_->foot(side, time); }

std::vector<std::string> PersonScript::moved_things() const {
  std::vector<std::string> names;
  for (const auto& [name, track] : movement_->things) names.push_back(name);
  return names;
}

std::function<Eigen::Isometry3d(double)> PersonScript::thing_motion(const std::string& name) const {
  HOLDFAST_CHECK(movement_->things.count(name) == 1, "thing '" << name << "' is not moved by this person");
  return [movement = movement_, name](double time) { return movement->thing(name, time); };
}

std::vector<std::pair<double, double>> PersonScript::holding_times(const std::string& name) const {
  std::vector<std::pair<double, double>> times;
  for (const Movement::Hold& hold : movement_->holds)
    if (hold.thing == name) times.emplace_back(hold.window.full, hold.window.fading);
  return times;
}

}  // namespace holdfast::simulation
