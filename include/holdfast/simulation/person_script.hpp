// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "holdfast/core/random.hpp"
#include "holdfast/simulation/footsteps.hpp"
#include "holdfast/simulation/limbs.hpp"
#include "holdfast/simulation/plan.hpp"
#include "holdfast/simulation/skeleton.hpp"

namespace holdfast::simulation {

class Movement;

/// Properties of an object in the room that a script requires. Objects are upright with their front towards -y.
struct ThingPlace {
  Eigen::Isometry3d T_world_thing = Eigen::Isometry3d::Identity();  ///< at rest, at time 0
  Eigen::AlignedBox3d extents;                                      ///< in the object's frame [m]
  std::string class_name;
  std::string moved_by;  ///< the person who pushes or carries it; set by PersonScript
  std::string used_by;   ///< the person who sits on it or puts an object on it; set by PersonScript
};
using ThingPlaces = std::map<std::string, ThingPlace>;

/// The execution of a person's plan: the position and posture of the person, and the poses of the objects that the
/// person moves, at any time [s] and in any order of queries. All motion is C1 in time: a planted foot does not move
/// (FootTrack), legs and arms are computed by inverse kinematics, and the pelvis is as high as the legs allow.
///
/// A person who pushes, carries or sits on an object, or puts an object on it, uses it exclusively: other people may
/// neither move it nor sit on it. Boxes, chairs, stools and plants on the floor can be pushed; these and small objects
/// on desks can be carried; neither is possible while another object is on top of them. Objects are put down on the
/// floor or on another object (on the seat of a chair, otherwise on its highest point), within 2 cm of its height.
/// People avoid neither each other nor furniture on their paths, but they walk around the object that they want to use.
/// Copies are cheap; queries from several threads at once are allowed.
class PersonScript {
 public:
  /// Executes `plan` at least until `duration`; afterwards (and before 0) the person does not move. Registers the
  /// person's name in `things`. While lifting and putting down objects the person stays within the `walls`
  /// (Stage::walls). \throws ConfigurationError for an unknown or unsuitable object, an empty route, a speed or time
  /// that is not positive, an object used by another person, an object too wide or too far away to be lifted, and if
  /// there is no free position for the person. The message begins with the index of the action: "do.1: Anna wants to
  /// ...".
  PersonScript(const Skeleton& skeleton, const PersonPlan& plan, ThingPlaces& things, const Eigen::AlignedBox3d& walls,
               double duration, Random style);

  /// Pose of the person's frame: on the floor below the pelvis, z up, face towards -y.
  Eigen::Isometry3d T_world_person(double time) const;
  Posture posture(double time) const;
  /// Pose of a foot in the world.
  FootPose foot(Side side, double time) const;

  /// Names of the objects that this person moves, sorted.
  std::vector<std::string> moved_things() const;
  /// T_world_object over time for one of moved_things(). It shares the script's data and stays valid without the
  /// script.
  std::function<Eigen::Isometry3d(double)> thing_motion(const std::string& name) const;
  /// Intervals in which the hands hold an object, as ordered pairs of begin and end [s].
  std::vector<std::pair<double, double>> holding_times(const std::string& name) const;

 private:
  std::shared_ptr<const Movement> movement_;
};

}  // namespace holdfast::simulation
