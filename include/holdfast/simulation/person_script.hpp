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

/// What a script must know of a thing in the room. Things stand upright with their front to -y.
struct ThingPlace {
  Eigen::Isometry3d T_world_thing = Eigen::Isometry3d::Identity();  ///< at rest, at time 0
  Eigen::AlignedBox3d extents;                                      ///< in the thing's frame [m]
  std::string class_name;
  std::string moved_by;  ///< the person who pushes or carries it; set by PersonScript
  std::string used_by;   ///< the person who sits on it or puts a thing on it; set by PersonScript
};
using ThingPlaces = std::map<std::string, ThingPlace>;

/// A person's plan played out: where the person is, how he holds himself, and where the things are that he moves, at
/// any time [s], in any order of asking. Everything is C1 in time: feet stand still on the floor while they bear
/// (FootTrack), legs and arms follow by inverse kinematics, the pelvis is as high as the legs allow.
///
/// Who pushes, carries or sits on a thing, or puts something on it, has it for himself: others may neither move it nor
/// sit on it, whoever's script is made first. Boxes, chairs, stools and plants that stand on the floor can be pushed;
/// these and the small things on desks can be carried; neither while something else stands on them. Things are put down
/// on the floor or on another thing (on a chair's seat, else on its highest point), at its height to 2 cm. People do
/// not evade one another, nor furniture on the way to places in their plan; they do go round the thing they want to
/// use. Cheap to copy; may be asked from several threads at once.
class PersonScript {
 public:
  /// Plays `plan` up to `duration` at least; afterwards (and before 0) the person stands still. Enters the person's
  /// name in `things`. To lift and put down things the person stands between the `walls` (Stage::walls).
  /// \throws ConfigurationError for an unknown or unsuitable thing, an empty route, a speed or time that is not
  /// positive, a thing that somebody else moves or sits on, a thing too wide or too far away to be lifted, and where no
  /// place is free to stand. The message begins with the action's number in the plan: "do.1: Anna wants to ...".
  PersonScript(const Skeleton& skeleton, const PersonPlan& plan, ThingPlaces& things, const Eigen::AlignedBox3d& walls,
               double duration, Random style);

  /// Of the person's root: on the floor below the pelvis, z up, face to -y.
  Eigen::Isometry3d T_world_person(double time) const;
  Posture posture(double time) const;
  /// A foot in the world.
  FootPose foot(Side side, double time) const;

  /// Names of the things that this person moves, sorted.
  std::vector<std::string> moved_things() const;
  /// T_world_thing over time for one of moved_things(). Shares the script's data; stays valid without it.
  std::function<Eigen::Isometry3d(double)> thing_motion(const std::string& name) const;
  /// When hands bear on a thing, as pairs of begin and end [s] in order.
  std::vector<std::pair<double, double>> holding_times(const std::string& name) const;

 private:
  std::shared_ptr<const Movement> movement_;
};

}  // namespace holdfast::simulation
