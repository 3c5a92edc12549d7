// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/camera.hpp"

namespace holdfast {

/// Cameras may have different names and be the same. How their rows are exposed does not matter to a map, whose
/// positions are those of images that were exposed at once.
inline bool have_other_numbers(Camera a, const Camera& b) {
  a.name = b.name;
  a.readout = b.readout;
  return a != b;
}

}  // namespace holdfast
