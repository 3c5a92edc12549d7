// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/frame.hpp"
#include "place_views.hpp"

namespace holdfast {

/// A recording of a visit: what it shows (PlaceView), and as frames with features, depth, mask and true pose.
struct Visit {
  Camera camera;
  std::vector<std::string> classes;
  std::vector<PlaceView> views;
  std::vector<Frame> frames;
};

/// All frames with a true pose of the source, given in YAML as in a configuration, with the masks of the segmenter;
/// features by `orb` with its defaults. Throws what configurations and their modules throw.
Visit read_visit(const std::string& source, const std::string& segmenter);

}  // namespace holdfast
