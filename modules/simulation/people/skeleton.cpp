// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/skeleton.hpp"

#include <algorithm>
#include <limits>

namespace holdfast::simulation {

using Eigen::Vector3d;

Bone parent(Bone bone) {
  static constexpr std::array<Bone, bone_count> parents = {
      Bone::pelvis,         Bone::pelvis,       Bone::abdomen, Bone::chest,           Bone::neck,          Bone::chest,
      Bone::left_upper_arm, Bone::left_forearm, Bone::chest,   Bone::right_upper_arm, Bone::right_forearm, Bone::pelvis,
      Bone::left_thigh,     Bone::left_shin,    Bone::pelvis,  Bone::right_thigh,     Bone::right_shin};
  return parents[index(bone)];
}

Skeleton::Skeleton(const Physique& physique) : physique_(physique) {
  const double height = physique.height, girth = physique.girth;
  ankle_height_ = 0.039 * height;
  const auto set = [&](Bone bone, const Vector3d& joint, double length) {
    joints_[index(bone)] = joint, lengths_[index(bone)] = length;
  };
  constexpr double hip = 0.530, waist = 0.600, chest = 0.690, shoulder = 0.818, neck = 0.830, chin = 0.878;
  const auto up = [&](double from, double to) { return Vector3d(0, 0, (to - from) * height); };
  set(Bone::pelvis, up(0.0, hip), (waist - hip) * height);
  set(Bone::abdomen, up(hip, waist), (chest - waist) * height);
  set(Bone::chest, up(waist, chest), (neck - chest) * height);
  set(Bone::neck, up(chest, neck), (chin - neck) * height);
  set(Bone::head, up(neck, chin), (1.0 - chin) * height);
  const double half_shoulder = 0.106 * height * (0.75 + 0.25 * girth), half_hip = 0.052 * height;
  for (const double side : {1.0, -1.0}) {
    const bool left = side > 0;
    const auto shoulder_joint = Vector3d(side * half_shoulder, 0, (shoulder - chest - 0.012) * height);
    set(left ? Bone::left_upper_arm : Bone::right_upper_arm, shoulder_joint, 0.186 * height);
    set(left ? Bone::left_forearm : Bone::right_forearm, Vector3d(0, 0, -0.186 * height), 0.146 * height);
    set(left ? Bone::left_hand : Bone::right_hand, Vector3d(0, 0, -0.146 * height), 0.108 * height);
    set(left ? Bone::left_thigh : Bone::right_thigh, Vector3d(side * half_hip, 0, 0), 0.245 * height);
    set(left ? Bone::left_shin : Bone::right_shin, Vector3d(0, 0, -0.245 * height), 0.246 * height);
    set(left ? Bone::left_foot : Bone::right_foot, Vector3d(0, 0, -0.246 * height), 0.152 * height);
  }
}

Posture Skeleton::standing() const {
  Posture posture;
  posture.pelvis = joint(Bone::pelvis);
  return posture;
}

BonePoses Skeleton::place(const Posture& posture) const {
  BonePoses poses;
  for (int i = 0; i < bone_count; ++i) {
    Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
    step.linear() = posture.rotations[i].toRotationMatrix();
    step.translation() = i == 0 ? posture.pelvis : joints_[i];
    poses[i] = i == 0 ? step : poses[index(parent(static_cast<Bone>(i)))] * step;
  }
  return poses;
}

void Skeleton::stand_on_floor(Posture& posture) const {
  const BonePoses poses = place(posture);
  double lowest = std::numeric_limits<double>::infinity();
  for (const Bone foot : {Bone::left_foot, Bone::right_foot}) {
    const double toe = -0.75 * length(foot), heel = 0.25 * length(foot);
    for (const double y : {toe, heel})
      lowest = std::min(lowest, (poses[index(foot)] * Vector3d(0, y, -ankle_height_)).z());
  }
  posture.pelvis.z() -= lowest;
}

}  // namespace holdfast::simulation
