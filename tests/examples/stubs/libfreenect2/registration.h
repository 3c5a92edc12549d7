// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "libfreenect2.hpp"

namespace libfreenect2 {

class Registration {
 public:
  Registration(Freenect2Device::IrCameraParams depth, Freenect2Device::ColorCameraParams colour);
  ~Registration();
  void apply(const Frame* colour, const Frame* depth, Frame* undistorted, Frame* registered, bool enable_filter = true,
             Frame* large_depth = nullptr) const;
};

}  // namespace libfreenect2
