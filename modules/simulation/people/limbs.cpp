// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/limbs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace holdfast::simulation {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr double easy_stretch = 0.93;  // of an arm's length

/// Rotations of both bones, which extend along their -z and bend about their common x.
struct Bent {
  Matrix3d upper, lower;
};

Matrix3d hanging(const Vector3d& direction, const Vector3d& hinge) {
  Matrix3d frame;
  frame.col(2) = -direction;
  frame.col(0) = hinge;
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

/// Bends a limb of two bones from `from` to `to` so that the joint between them lies on the side of `pole`;
/// `hinge_sign` tells which way x points: -1 for knees, which lie to the front, +1 for elbows.
Bent bend(const Vector3d& from, const Vector3d& to, double upper, double lower, const Vector3d& pole,
          double hinge_sign) {
  const Vector3d span = to - from;
  const double longest = (upper + lower) * (1.0 - 1e-6), shortest = std::abs(upper - lower) + 0.02;
  const double distance = std::clamp(span.norm(), shortest, longest);
  const Vector3d along = span.normalized(), out = (pole - pole.dot(along) * along).normalized();
  const double cosine = (upper * upper + distance * distance - lower * lower) / (2.0 * upper * distance);
  const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  const Vector3d joint = upper * (cosine * along + sine * out);
  const Vector3d hinge = hinge_sign * along.cross(out);
  return {hanging(joint / upper, hinge), hanging((distance * along - joint).normalized(), hinge)};
}

}  // namespace

void place_foot(const Skeleton& skeleton, const Eigen::Isometry3d& T_person_pelvis, Side side, const Vector3d& ankle,
                const Quaterniond& foot, Posture& posture) {
  const Limb limb = leg(side);
  const Vector3d hip = T_person_pelvis * skeleton.joint(limb.upper);
  // Half way between where the foot and the pelvis point, and a little up, which decides while the thigh is level.
  Vector3d front = foot * -Vector3d::UnitY() - T_person_pelvis.linear().col(1);
  front.z() = 0.0;
  front = front.normalized() + Vector3d(0, 0, 0.3);
  const Bent bent = bend(hip, ankle, skeleton.length(limb.upper), skeleton.length(limb.lower), front, -1.0);
  posture.rotations[index(limb.upper)] = Quaterniond(T_person_pelvis.linear().transpose() * bent.upper);
  posture.rotations[index(limb.lower)] = Quaterniond(bent.upper.transpose() * bent.lower);
  posture.rotations[index(limb.end)] = Quaterniond(bent.lower).conjugate() * foot;
}

double palm_distance(const Skeleton& skeleton) { return 0.42 * skeleton.length(Bone::left_hand); }

HandPose hand_on(const Skeleton& skeleton, Side side, const Vector3d& point, const Vector3d& palm,
                 const Vector3d& fingers) {
  const Vector3d inwards = palm.normalized();
  const Vector3d along = (fingers - fingers.dot(inwards) * inwards).normalized();
  Matrix3d rotation = hanging(along, -sign(side) * inwards);
  return {point - palm_depth * inwards - palm_distance(skeleton) * along, Quaterniond(rotation)};
}

Vector3d palm_of(const Skeleton& skeleton, Side side, const Eigen::Isometry3d& hand) {
  return hand * Vector3d(-sign(side) * palm_depth, 0, -palm_distance(skeleton));
}

void reach(const Skeleton& skeleton, const Eigen::Isometry3d& T_person_chest, Side side, const HandPose& hand,
           double weight, Posture& posture) {
  if (weight <= 0.0) return;
  const Limb limb = arm(side);
  const Vector3d shoulder = T_person_chest * skeleton.joint(limb.upper);
  // Near full stretch the elbow would snap straight; the arm yields a little before.
  const Vector3d span = hand.wrist - shoulder;
  const double whole = skeleton.length(limb.upper) + skeleton.length(limb.lower), firm = easy_stretch * whole,
               distance = span.norm(), spare = 0.998 * whole - firm;
  const double reached = distance <= firm ? distance : firm + spare * (1.0 - std::exp((firm - distance) / spare));
  const Vector3d wrist_place = shoulder + span * (reached / distance);
  const Vector3d pole = T_person_chest.linear() * Vector3d(0.3 * sign(side), 0.5, 0.0) - Vector3d(0, 0, 1.0);
  const Bent bent = bend(shoulder, wrist_place, skeleton.length(limb.upper), skeleton.length(limb.lower), pole, 1.0);
  // The forearm takes half of the hand's twist, as radius and ulna do.
  const Quaterniond wrist = Quaterniond(bent.lower).conjugate() * hand.rotation;
  const double twist = 2.0 * std::atan2(wrist.z(), wrist.w());
  const double half = 0.5 * std::remainder(twist, 2.0 * std::numbers::pi);
  const Quaterniond forearm = Quaterniond(bent.lower) * Quaterniond(Eigen::AngleAxisd(half, Vector3d::UnitZ()));
  const auto turn = [&](Bone bone, const Quaterniond& rotation) {
    Quaterniond& current = posture.rotations[index(bone)];
    current = weight >= 1.0 ? rotation : current.slerp(weight, rotation);
  };
  turn(limb.upper, Quaterniond(T_person_chest.linear().transpose() * bent.upper));
  turn(limb.lower, Quaterniond(bent.upper.transpose()) * forearm);
  turn(limb.end, forearm.conjugate() * hand.rotation);
}

}  // namespace holdfast::simulation
