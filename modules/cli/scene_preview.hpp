// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "holdfast/simulation/simulator.hpp"

namespace holdfast {

/// A picture (8UC3) that shows a scene at a glance: `columns` by `rows` frames spread evenly over its time, as the
/// sensors see them, with the outline and number of everything in the object masks that is more
/// than a speck, and whether it moves; and below them the room from
/// above with a grid of metres, the camera's way and the ways of what moves, by number and name.
cv::Mat scene_preview(simulation::Simulator& simulator, int columns = 4, int rows = 3);

}  // namespace holdfast
