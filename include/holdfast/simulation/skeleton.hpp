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
/// The parent of a bone; the pelvis is its own parent.
Bone parent(Bone bone);

/// Physique of a person.
struct Physique {
  double height = 1.75;  ///< [m]
  double girth = 1.0;    ///< width and depth of the body, relative to the average for the height
};

/// Posture of a person at one time.
struct Posture {
  /// Rotation of each bone relative to its parent (of the pelvis, relative to the person's frame). The identity is an
  /// upright posture with hanging arms, palms towards the thighs and toes towards -y.
  std::array<Eigen::Quaterniond, bone_count> rotations;
  Eigen::Vector3d pelvis = Eigen::Vector3d::Zero();  ///< position of the pelvis in the person's frame [m]

  Posture() { rotations.fill(Eigen::Quaterniond::Identity()); }
};

/// Poses T_person_bone, by bone.
using BonePoses = std::array<Eigen::Isometry3d, bone_count>;

/// Bone lengths and kinematic tree of a person. Segment lengths as fractions of the height by Drillis and Contini
/// (1966) as printed by Winter (Biomechanics and Motor Control of Human Movement, 2009, figure 4.1).
///
/// A person's frame is on the floor below the pelvis with z up, the face towards -y and the left hand towards +x. The
/// frame of a bone has its origin in the joint to its parent and, in the upright posture, axes parallel to the
/// person's; thus arms, thighs and shins extend along -z, bones of the trunk along +z, and feet along -y. Forward
/// flexion is a rotation about +x by a negative angle for hip, shoulder and elbow, and by a positive angle for the knee
/// (the shin moves backwards); bending the trunk or head forward is a rotation about +x by a positive angle.
class Skeleton {
 public:
  explicit Skeleton(const Physique& physique);

  const Physique& physique() const { return physique_; }
  /// Joint of a bone in its parent's frame [m]; that of the pelvis in the person's frame in the upright posture.
  const Eigen::Vector3d& joint(Bone bone) const { return joints_[index(bone)]; }
  /// Length of a bone from its joint to the next one or its end [m]; of the foot: from heel to toe.
  double length(Bone bone) const { return lengths_[index(bone)]; }
  /// Height of the ankle above the floor [m].
  double ankle_height() const { return ankle_height_; }

  /// The upright posture.
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
