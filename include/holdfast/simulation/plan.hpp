// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "holdfast/plugin/parameter_table.hpp"
#include "holdfast/simulation/skeleton.hpp"

/// What the people in a scene set out to do. Places are in the room's frame [m], things are named as in
/// World::objects ("chair 2").
namespace holdfast::simulation {

/// Walks past the given places to the last one, rounding corners; where they are too sharp for that, stops and turns.
struct Walk {
  std::vector<Eigen::Vector2d> to;
  double speed = 1.1;  ///< [m/s]
};

/// Stands for a while.
struct Stand {
  double duration = 2.0;  ///< [s]
  bool gesture = false;   ///< talks with the hands
  std::optional<Eigen::Vector2d> facing;
};

/// Goes to a chair, sits down, stays, and stands up again. The chair's front is where the legs go; it needs 0.5 m of
/// free floor there. Under a desk's edge the hands lie on the desk, else on the thighs.
struct Sit {
  std::string on;
  double duration = 6.0;  ///< from seated to rising [s]
  bool gesture = false;
};

/// Goes behind a thing on the floor and pushes it past the given places to the last one. A chair is swivelled so that
/// its back comes into the hands, other things keep the side that they have. Where a corner is too sharp the person
/// lets go and walks round the thing to push from there. Places where the thing is already are left out.
struct Push {
  std::string thing;
  std::vector<Eigen::Vector2d> to;  ///< of the thing
  double speed = 0.7;               ///< [m/s]
};

/// Goes to a thing at most 0.8 m wide, on the floor or on a table, lifts it with both hands, carries it before the
/// chest past the given places (of the person) and puts it down, from the side where the last of them is if there is
/// room to stand, turned to the person as it was when lifted.
struct Carry {
  std::string thing;
  std::vector<Eigen::Vector2d> to;
  Eigen::Vector3d put_at = Eigen::Vector3d::Zero();  ///< where the thing's origin comes to stand
  double speed = 0.9;                                ///< [m/s]
};

using Action = std::variant<Walk, Stand, Sit, Push, Carry>;

/// One person's part in a scene.
struct PersonPlan {
  std::string name;  ///< "" = "person K"
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  std::optional<Eigen::Vector2d> facing;  ///< looks there at first; otherwise where the first action leads
  std::optional<double> height, girth;    ///< chosen by the seed where absent
  double start = 0.0;                     ///< stands still until then [s]
  bool repeat = true;                     ///< begins anew after the last action (going back to `at`); else stands
  std::vector<Action> actions;
};

/// A thing that turns about its own z axis: a door on its hinge.
struct SwingPlan {
  std::string thing = "door 1";
  double angle = 1.4;    ///< open [rad]
  double start = 2.0;    ///< begins to open [s]
  double opening = 1.5;  ///< time to open, and to close [s]
  double open = 2.0;     ///< stays open [s]
  double shut = 3.0;     ///< stays shut before it opens again [s]

  static void describe(ParameterTable<SwingPlan>& table);
};

}  // namespace holdfast::simulation
