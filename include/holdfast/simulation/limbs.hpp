// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "holdfast/simulation/skeleton.hpp"

/// Arms and legs that reach a point: the two lengths of a limb and the law of cosines leave only the side to which the
/// joint between them points.
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

/// Bends a leg so that the ankle comes to a point and the foot to a rotation, both in the person's frame; the knee
/// points to the foot's front. `T_person_pelvis` is the pelvis. A point out of reach leaves the leg stretched to it.
void place_foot(const Skeleton& skeleton, const Eigen::Isometry3d& T_person_pelvis, Side side,
                const Eigen::Vector3d& ankle, const Eigen::Quaterniond& foot, Posture& posture);

/// Where a hand is to be: the wrist, and how the hand is turned, in the person's frame.
struct HandPose {
  Eigen::Vector3d wrist;
  Eigen::Quaterniond rotation;
};

/// From the wrist to the middle of the palm, along the hand, and how thick hand and palm are there [m].
double palm_distance(const Skeleton& skeleton);
constexpr double palm_depth = 0.02;

/// The hand whose palm lies on `point`, facing along `palm`, fingers along `fingers` (made perpendicular to the palm).
HandPose hand_on(const Skeleton& skeleton, Side side, const Eigen::Vector3d& point, const Eigen::Vector3d& palm,
                 const Eigen::Vector3d& fingers);
/// The middle of the palm's surface for a hand bone's pose; the inverse of hand_on.
Eigen::Vector3d palm_of(const Skeleton& skeleton, Side side, const Eigen::Isometry3d& hand);

/// Turns an arm towards a hand pose: with weight 1 the wrist is there, in between the joints are turned part of the
/// way from what they were (slerp). The elbow points down, back and outwards. Beyond 93 % of the arm's length the wrist
/// falls short, by 0.2 % of the length at 95 % and 1 % at 97 %.
void reach(const Skeleton& skeleton, const Eigen::Isometry3d& T_person_chest, Side side, const HandPose& hand,
           double weight, Posture& posture);

}  // namespace holdfast::simulation
