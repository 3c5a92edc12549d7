// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/viewer/viewer.hpp"

namespace holdfast::viewer_plugin {

/// Finds the classes of map points: the majority of the labels that the masks of frames have where a point is observed
/// (Boyer and Moore 1981, "MJRTY", with a bound on the count, so that a point whose label was wrong for long can still
/// change). Frames without a mask, and cells that the mask does not know, say nothing. One thread.
class PointClasses {
 public:
  /// Counts the labels of a frame's map points. Returns the points whose class is new or has changed.
  std::vector<ViewedClass> add(const Frame& frame);

 private:
  struct Vote {
    std::uint32_t generation = 0;  // of the point
    std::uint8_t label = 0, count = 0;
    bool known = false;  // whether the label was returned
  };
  std::vector<Vote> votes_;  // by slot of the point
};

}  // namespace holdfast::viewer_plugin
