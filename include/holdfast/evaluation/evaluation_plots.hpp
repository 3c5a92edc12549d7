// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "holdfast/evaluation/evaluation.hpp"

namespace holdfast {

/// Plots one coordinate (0 = x, 1 = y, 2 = z) of the aligned estimate and of the ground truth over time, in the world
/// frame of the ground truth. Frames without a pose are shaded as in error_over_time_svg(). Self-contained SVG.
std::string position_over_time_svg(const Evaluation& evaluation, int axis);

/// Plots one angle (0 = roll, 1 = pitch, 2 = yaw) of the aligned estimate and of the ground truth over time in degrees,
/// as camera_angles() defines them. Frames without a pose are shaded as in error_over_time_svg(). Self-contained SVG.
std::string angle_over_time_svg(const Evaluation& evaluation, int angle);

}  // namespace holdfast
