// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

namespace holdfast::simulation {

/// The bones of a person, parents before children. Left and right are the person's own.
enum class Bone : std::uint8_t {
  pelvis,
  abdomen,
  chest,
  neck,
  head,
  left_upper_arm,
  left_forearm,
  left_hand,
  right_upper_arm,
  right_forearm,
  right_hand,
  left_thigh,
  left_shin,
  left_foot,
  right_thigh,
  right_shin,
  right_foot
};
inline constexpr int bone_count = 17;
constexpr int index(Bone bone) { return static_cast<int>(bone); }
/// The bone that a bone hangs on; the pelvis is its own parent.
Bone parent(Bone bone);

/// How somebody is built.
struct Physique {
  double height = 1.75;  ///< [m]
  double girth = 1.0;    ///< breadth and depth of the body, as a factor on the average for the height
};

/// How somebody holds himself at a moment.
struct Posture {
  /// Of each bone against its parent (the pelvis: against the person's frame). Identity everywhere is standing upright,
  /// arms hanging, palms to the thighs, toes to -y.
  std::array<Eigen::Quaterniond, bone_count> rotations;
  Eigen::Vector3d pelvis = Eigen::Vector3d::Zero();  ///< position of the pelvis in the person's frame [m]

  Posture() { rotations.fill(Eigen::Quaterniond::Identity()); }
};

/// Poses T_person_bone, by bone.
using BonePoses = std::array<Eigen::Isometry3d, bone_count>;

/// The lengths of a person's bones and how they hang together. Segment lengths as shares of the height after Drillis
/// and Contini (1966) as printed by Winter (Biomechanics and Motor Control of Human Movement, 2009, figure 4.1).
///
/// A person's frame stands on the floor below the pelvis with z up, the face to -y, the left hand to +x. A bone's frame
/// has its origin in the joint to its parent and, standing upright, axes parallel to the person's; so bones that hang
/// down (arms, thighs, shins) extend along -z, those of the trunk along +z, feet along -y. Bending a joint forward is a
/// turn about +x by a negative angle for limbs that hang down (hip, shoulder, elbow) and positive for the knee (the
/// shin goes back); bowing the trunk or head forward is a turn about +x by a positive angle.
class Skeleton {
 public:
  explicit Skeleton(const Physique& physique);

  const Physique& physique() const { return physique_; }
  /// Joint of a bone in its parent's frame [m]; of the pelvis: in the person's frame when standing.
  const Eigen::Vector3d& joint(Bone bone) const { return joints_[index(bone)]; }
  /// Length of a bone from its joint to the next one or its end [m]; of the foot: from heel to toe.
  double length(Bone bone) const { return lengths_[index(bone)]; }
  /// From the ankle down to the floor [m].
  double ankle_height() const { return ankle_height_; }

  /// Standing upright.
  Posture standing() const;
  /// Forward kinematics.
  BonePoses place(const Posture& posture) const;
  /// Raises or lowers the pelvis so that the lowest point of both soles touches the floor.
  void stand_on_floor(Posture& posture) const;

 private:
  Physique physique_;
  std::array<Eigen::Vector3d, bone_count> joints_;
  std::array<double, bone_count> lengths_{};
  double ankle_height_ = 0.0;
};

}  // namespace holdfast::simulation
