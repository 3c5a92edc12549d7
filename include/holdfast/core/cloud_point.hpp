// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace holdfast {

/// A coloured point of a dense cloud [m]. The coordinate frame is documented with the cloud.
struct CloudPoint {
  float x = 0, y = 0, z = 0;
  std::uint8_t red = 0, green = 0, blue = 0;

  friend bool operator==(const CloudPoint&, const CloudPoint&) = default;
};

}  // namespace holdfast
