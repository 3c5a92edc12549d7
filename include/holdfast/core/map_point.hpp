// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "holdfast/core/build_layout.hpp"
#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/class_votes.hpp"
#include "holdfast/core/descriptor.hpp"
#include "holdfast/core/id.hpp"

namespace holdfast {

/// One observation of a map point: a feature of a keyframe.
struct Observation {
  KeyFrameId keyframe;
  std::uint32_t feature = 0;
};

/// A point of the static world. It is modified through Map, which keeps points and keyframes consistent.
struct MapPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();           ///< world [m]
  Eigen::Vector3d viewing_direction = Eigen::Vector3d::Zero();  ///< mean camera-to-point direction, unit, world
  float minimum_distance = 0.0F;  ///< distance range in which the descriptor can be matched [m]
  float maximum_distance = 0.0F;
  DescriptorBlock descriptor{DescriptorType(),
                             1};          ///< observed descriptor with the least median distance to the others
  std::vector<Observation> observations;  ///< in order of insertion
  KeyFrameId reference_keyframe;          ///< first keyframe that still observes it
  std::uint64_t created_at = 0;           ///< sequence number of the keyframe that created it
  std::uint32_t visible_count = 1;        ///< frames in which it is predicted to be visible
  std::uint32_t found_count = 1;          ///< frames in which it was matched
  float static_log_odds = 0.0F;           ///< accumulated log-odds that the point is static; 0 = unknown
  /// Class, an index into Map::classes(). Set at the end of a run by Map::classify_points().
  std::uint8_t label = CellMask::unknown;
  /// Votes of masks that are no longer in the map: of removed keyframes and of the runs that made a loaded map.
  /// Map::class_votes() adds those of the present observations.
  ClassVotes earlier_votes;

  float found_ratio() const { return static_cast<float>(found_count) / static_cast<float>(visible_count); }
};

}  // namespace holdfast
