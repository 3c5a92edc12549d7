// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "holdfast/core/descriptor.hpp"
#include "holdfast/core/id.hpp"

namespace holdfast {

/// One sight of a map point.
struct Observation {
  KeyFrameId keyframe;
  std::uint32_t feature = 0;
};

/// A point of the static world. Changed through Map, which keeps points and keyframes consistent.
struct MapPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();           ///< world [m]
  Eigen::Vector3d viewing_direction = Eigen::Vector3d::Zero();  ///< unit mean of camera-to-point directions, world
  float minimum_distance = 0.0F;                                ///< from which the descriptor can be found again [m]
  float maximum_distance = 0.0F;
  Descriptor descriptor;                  ///< the observation nearest to all others in Hamming distance
  std::vector<Observation> observations;  ///< ordered by time of adding
  KeyFrameId reference_keyframe;          ///< first keyframe that still sees it
  std::uint64_t created_at = 0;           ///< sequence number of the keyframe that made it
  std::uint32_t visible_count = 1;        ///< frames in which it should have been seen
  std::uint32_t found_count = 1;          ///< frames in which it was
  float static_log_odds = 0.0F;           ///< evidence that the point stands still; 0 = unknown

  float found_ratio() const { return static_cast<float>(found_count) / static_cast<float>(visible_count); }
};

}  // namespace holdfast
