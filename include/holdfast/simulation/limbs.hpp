// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "holdfast/simulation/skeleton.hpp"

/// Inverse kinematics of arms and legs: the lengths of the two bones and the law of cosines determine the pose except
/// for the direction of the joint between them.
namespace holdfast::simulation {

enum class Side { left, right };
/// +1 on the left, where x is positive; -1 on the right.
constexpr double sign(Side side) { return side == Side::left ? 1.0 : -1.0; }

/// The bones of a limb from the trunk outwards.
struct Limb {
  Bone upper, lower, end;
};
constexpr Limb arm(Side side) {
  return side == Side::left ? Limb{Bone::left_upper_arm, Bone::left_forearm, Bone::left_hand}
                            : Limb{Bone::right_upper_arm, Bone::right_forearm, Bone::right_hand};
}
constexpr Limb leg(Side side) {
  return side == Side::left ? Limb{Bone::left_thigh, Bone::left_shin, Bone::left_foot}
                            : Limb{Bone::right_thigh, Bone::right_shin, Bone::right_foot};
}

/// Moves a leg so that the ankle reaches a point and the foot a rotation, both in the person's frame; the knee points
/// towards the front of the foot. `T_person_pelvis` is the pose of the pelvis. If the point is out of reach, the leg is
/// stretched towards it.
void place_foot(const Skeleton& skeleton, const Eigen::Isometry3d& T_person_pelvis, Side side,
                const Eigen::Vector3d& ankle, const Eigen::Quaterniond& foot, Posture& posture);

/// Target pose of a hand in the person's frame: position of the wrist and rotation of the hand.
struct HandPose {
  Eigen::Vector3d wrist;
  Eigen::Quaterniond rotation;
};

/// Distance from the wrist to the centre of the palm along the hand, and thickness of the hand there [m].
double palm_distance(const Skeleton& skeleton);
constexpr double palm_depth = 0.02;

/// The hand pose with the palm at `point`, its normal along `palm` and the fingers along `fingers` (made perpendicular
/// to the normal).
HandPose hand_on(const Skeleton& skeleton, Side side, const Eigen::Vector3d& point, const Eigen::Vector3d& palm,
                 const Eigen::Vector3d& fingers);
/// The centre of the palm's surface for the pose of a hand bone; the inverse of hand_on.
Eigen::Vector3d palm_of(const Skeleton& skeleton, Side side, const Eigen::Isometry3d& hand);

/// Moves an arm towards a hand pose: with weight 1 the wrist reaches it, with smaller weights the joint rotations are
/// interpolated (slerp). The elbow points down, back and outwards. Beyond 93 % of the arm's length the wrist does not
/// reach the target completely, by 0.2 % of the length at 95 % and 1 % at 97 %.
void reach(const Skeleton& skeleton, const Eigen::Isometry3d& T_person_chest, Side side, const HandPose& hand,
           double weight, Posture& posture);

}  // namespace holdfast::simulation
