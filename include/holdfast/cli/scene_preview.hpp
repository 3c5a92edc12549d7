// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "holdfast/simulation/simulator.hpp"

namespace holdfast {

/// A picture (8UC3) that shows a scene at a glance: `columns` by `rows` frames spread evenly over its time, as the
/// sensors see them, with the outline, number and name of everything in the object masks; and below them the room from
/// above with a grid of metres, the camera's way and the ways of what moves.
cv::Mat scene_preview(simulation::Simulator& simulator, int columns = 4, int rows = 3);

}  // namespace holdfast
