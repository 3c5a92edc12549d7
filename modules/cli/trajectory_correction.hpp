// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "holdfast/core/trajectory.hpp"

namespace holdfast {

/// Conversion of a trajectory that was written with other conventions than those of docs/conventions.md.
struct TrajectoryCorrection {
  bool is_inverted = false;          ///< poses are T_camera_world
  double metres_per_unit = 1.0;      ///< of positions
  std::optional<int> mirrored_axis;  ///< 0 to 2: this axis of the world and of the camera is reversed (left-handed)

  /// The conversion in words, "inverted, in millimetres"; empty for none.
  std::string text() const;
};

/// Converts each pose: unit of length first, then mirror, then inverse.
Trajectory corrected(const TrajectoryCorrection& correction, Trajectory trajectory);

}  // namespace holdfast
