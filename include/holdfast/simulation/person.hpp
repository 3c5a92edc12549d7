// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "holdfast/core/random.hpp"
#include "holdfast/simulation/pictures.hpp"
#include "holdfast/simulation/skeleton.hpp"
#include "holdfast/simulation/world.hpp"

namespace holdfast::simulation {

enum class HairStyle { bald, cropped, parted, curly, shoulder_length, bun };
enum class Top { t_shirt, shirt, pullover, jacket };
enum class Bottom { trousers, shorts, skirt };

/// Appearance of a person in addition to the physique. Colours are blue green red, 0 to 255, in full light.
struct PersonLook {
  double figure = 0.0;  ///< shape of the trunk: 0 typically male, 1 typically female
  cv::Scalar skin;
  HairStyle hair_style = HairStyle::cropped;
  cv::Scalar hair;
  bool beard = false, glasses = false;

  Top top = Top::t_shirt;
  pictures::Cloth top_cloth;
  bool long_sleeves = false, tucked_in = false;
  pictures::Cloth under_jacket;

  Bottom bottom = Bottom::trousers;
  pictures::Cloth bottom_cloth;
  cv::Scalar shoes, soles;
};

/// Generates a random appearance.
PersonLook random_look(Random random);

/// Creates an object of class "person" in the rest posture (Skeleton::standing()) in the person's frame. Its textures
/// are added to the world, the object itself is not. The mesh is skinned (Mesh::skin, indexed by Bone). It has no
/// solids and casts no baked shadows.
Object make_person(World& world, const std::string& name, const Skeleton& skeleton, const PersonLook& look,
                   Random random);

}  // namespace holdfast::simulation
