// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/pinhole.hpp"

namespace holdfast::geometry {

using holdfast::Pinhole;

/// Reads the intrinsics of a caller's camera type. The default takes the members fx, fy, cx, cy and, where there is
/// one, baseline. Specialise it for a camera that stores them otherwise.
template <class Camera>
struct CameraTraits {
  static Pinhole pinhole(const Camera& camera) {
    Pinhole result{camera.fx, camera.fy, camera.cx, camera.cy, 0.0};
    if constexpr (requires { camera.baseline; }) result.baseline = camera.baseline;
    return result;
  }
};

/// Intrinsics of any camera type with CameraTraits.
template <class Camera>
Pinhole pinhole_of(const Camera& camera) {
  return CameraTraits<Camera>::pinhole(camera);
}

}  // namespace holdfast::geometry
