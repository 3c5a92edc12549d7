// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "holdfast/simulation/person_script.hpp"
#include "movement.hpp"

namespace holdfast::simulation {

/// Turns a plan's actions into a movement, one after the other.
class ScriptBuilder {
 public:
  ScriptBuilder(Movement& movement, const PersonPlan& plan, ThingPlaces& things, const Eigen::AlignedBox3d& walls)
      : movement_(movement), plan_(plan), things_(things), walls_(walls) {}

  /// Plays an action of the plan, which has this number there (from 0). What it refuses, it refuses as "do.NUMBER:
  /// ...".
  void play(const Action& action, std::size_t number);
  /// Goes back to where the plan began.
  void return_to_start();

 private:
  struct Obstacle {
    Eigen::Vector2d centre;
    double radius;
  };
  enum class Handling { push, carry };
  /// Where to stand before a thing so that its sides are left and right.
  struct Standpoint {
    Eigen::Vector2d position;
    double heading;
  };
  /// A thing as somebody sees it who faces it with a heading.
  struct Seen {
    double half_width, half_depth;
    Eigen::Vector3d centre;  ///< of the extents, in the thing's frame
    Eigen::Vector3d left, forward;
  };

  /// A thing that is about to be carried: the side from which it is lifted, and how it is held.
  struct Load {
    Eigen::Isometry3d T_world_thing;
    Standpoint stand{};
    Grips grips;
    Seen seen{};
    Eigen::Isometry3d T_person_held = Eigen::Isometry3d::Identity();
  };

  void walk(const Walk& action);
  void stand(const Stand& action);
  void sit(const Sit& action);
  void push(const Push& action);
  /// Past places between which no corner is too sharp to push round.
  void push_along(const Push& action, const std::vector<Eigen::Vector2d>& places);
  /// Walks behind a thing that is to be pushed and reaches for it.
  Movement::Bend step_behind(const std::string& name, const Standpoint& stand, const Obstacle& around,
                             const Eigen::Isometry3d& T_world_thing, const Grips& grips);
  void carry(const Carry& action);
  /// Of the four sides of a thing the nearest from which it can be lifted.
  Load choose_side(const Carry& action);
  /// Walks with the load to a place from which it can be put down, and returns the pose that it gets.
  Eigen::Isometry3d carry_to(const Carry& action, const Load& load);
  Movement::Bend bend_to(const std::string& name, const Grips& grips, const Eigen::Isometry3d& T_world_rest);

  /// Walks to a place, past others, round what must not be walked through.
  void go(std::vector<Eigen::Vector2d> points, double speed, const std::optional<Obstacle>& obstacle);
  ThingPlace& thing(const std::string& name, const std::string& doing);
  ThingPlace& claim(const std::string& name, Handling handling);
  bool others(const std::string& person) const;
  bool of_another(const ThingPlace& place) const { return others(place.moved_by) || others(place.used_by); }
  /// Why a thing cannot be pushed or carried, as a relative clause; empty if it can.
  std::string hindrance(const std::string& name, Handling handling) const;
  /// Whether a point is above or below a thing's footprint.
  bool in_footprint(const std::string& name, const Eigen::Vector3d& point) const;
  /// How high something lies on a thing [m].
  double bearing_height(const std::string& name) const;
  /// What stands on a thing; empty = nothing.
  std::string thing_on(const std::string& name) const;
  void check_put_down(const Carry& action);
  Eigen::Isometry3d rest(const std::string& name) const;
  void check_positive(double value, const std::string& what) const;
  void check_route(const std::vector<Eigen::Vector2d>& to, const std::string& doing) const;
  [[noreturn]] void refuse(const std::string& problem) const;
  bool free_to_stand(const Eigen::Vector2d& position, const std::string& except) const;
  double table_before(const Eigen::Isometry3d& T_world_chair) const;

  Seen see(const Eigen::Isometry3d& T_world_thing, const Eigen::AlignedBox3d& extents, double heading) const;
  /// How far to bow (and with `knees`, to squat) so that both wrists reach these palms; nothing when too far.
  std::optional<Movement::Bend> bend_to_reach(const Grips& grips, const Eigen::Isometry3d& T_person_thing,
                                              bool knees) const;
  /// The first free place, the most comfortable distance first, from which the grips can be reached, facing along a
  /// heading.
  std::optional<Standpoint> place_before(const Eigen::Isometry3d& T_world_thing, const std::string& name,
                                         double heading, const Grips& grips) const;

  Movement& movement_;
  const PersonPlan& plan_;
  ThingPlaces& things_;
  const Eigen::AlignedBox3d& walls_;
  std::size_t action_number_ = 0;
  std::optional<Obstacle> behind_;  ///< what the person has just let go of
};

constexpr double seat_height = 0.50;  // of chairs [m]
constexpr double widest_load = 0.8;   // [m]
constexpr double approaching = 1.0;   // speed on ways that the plan does not tell [m/s]

inline Eigen::Vector3d flat(const Eigen::Vector2d& v) { return {v.x(), v.y(), 0.0}; }
/// Heading of an upright thing [rad].
inline double yaw_of(const Eigen::Isometry3d& pose) { return std::atan2(pose.linear()(1, 0), pose.linear()(0, 0)); }
inline Eigen::Isometry3d turned(double yaw) {
  return Eigen::Isometry3d(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
}

}  // namespace holdfast::simulation
