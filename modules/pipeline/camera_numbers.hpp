// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/camera.hpp"

namespace holdfast {

/// Cameras may have different names and be the same.
inline bool have_other_numbers(Camera a, const Camera& b) {
  a.name = b.name;
  return a != b;
}

}  // namespace holdfast
