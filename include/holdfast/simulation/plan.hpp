// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "holdfast/plugin/parameter_table.hpp"
#include "holdfast/simulation/skeleton.hpp"

/// Actions of the people in a scene. Positions are in the room's frame [m]; objects are named as in World::objects
/// ("chair 2").
namespace holdfast::simulation {

/// Walks through the given positions to the last one on a path with rounded corners; at sharp corners the person stops
/// and turns.
struct Walk {
  std::vector<Eigen::Vector2d> to;
  double speed = 1.1;  ///< [m/s]
};

/// Stands for a duration.
struct Stand {
  double duration = 2.0;  ///< [s]
  bool gesture = false;   ///< whether the person gestures
  std::optional<Eigen::Vector2d> facing;
};

/// Walks to a chair, sits down, stays seated, and stands up again. 0.5 m of free floor is required in front of the
/// chair. At a desk the hands rest on the desk, otherwise on the thighs.
struct Sit {
  std::string on;
  double duration = 6.0;  ///< from seated to rising [s]
  bool gesture = false;
};

/// Walks behind an object on the floor and pushes it through the given positions to the last one. A chair is swivelled
/// so that its back faces the hands; other objects keep their orientation. At a sharp corner the person releases the
/// object and walks around it to push from the other side. Positions at which the object already is are skipped.
struct Push {
  std::string thing;
  std::vector<Eigen::Vector2d> to;  ///< of the object
  double speed = 0.7;               ///< [m/s]
};

/// Walks to an object of at most 0.8 m width on the floor or on a table, lifts it with both hands, carries it in front
/// of the chest through the given positions (of the person) and puts it down. The person stands on the side of the last
/// position if there is free floor; the object keeps its orientation relative to the person.
struct Carry {
  std::string thing;
  std::vector<Eigen::Vector2d> to;
  Eigen::Vector3d put_at = Eigen::Vector3d::Zero();  ///< final position of the object's origin
  double speed = 0.9;                                ///< [m/s]
};

using Action = std::variant<Walk, Stand, Sit, Push, Carry>;

/// One person's part in a scene.
struct PersonPlan {
  std::string name;  ///< "" = "person K"
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  std::optional<Eigen::Vector2d> facing;  ///< initial viewing target; otherwise the target of the first action
  std::optional<double> height, girth;    ///< derived from the seed if absent
  double start = 0.0;                     ///< start of the first action [s]
  bool repeat = true;                     ///< whether the actions are repeated (after returning to `at`)
  std::vector<Action> actions;
};

/// An object that rotates about its own z axis, such as a door on its hinge.
struct SwingPlan {
  std::string thing = "door 1";
  double angle = 1.4;    ///< open [rad]
  double start = 2.0;    ///< time of the first opening [s]
  double opening = 1.5;  ///< duration of opening and of closing [s]
  double open = 2.0;     ///< duration of being open [s]
  double shut = 3.0;     ///< duration of being closed before the next opening [s]

  static void describe(ParameterTable<SwingPlan>& table);
};

}  // namespace holdfast::simulation
