// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace holdfast {

/// A vertex of a mesh in world coordinates.
struct MeshVertex {
  static constexpr std::uint8_t unknown_class = 255;

  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< [m]
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();    ///< unit, towards free space; zero if unknown
  std::uint8_t red = 0, green = 0, blue = 0;
  std::uint8_t label = unknown_class;  ///< index into the classes of the segmenter, 0 = background
};

}  // namespace holdfast
