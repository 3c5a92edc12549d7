// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "holdfast/core/simd.hpp"
#include "holdfast/optical_flow/image_pyramid.hpp"

namespace holdfast {

/// Points in two images; entry i of each array belongs to point i. Positions are in pixels of the full image.
struct PointFlow {
  std::vector<float> from_x, from_y;  ///< input: the points in the first image
  std::vector<float> to_x, to_y;      ///< input: predicted positions in the second image; output: estimated positions
  std::vector<std::uint8_t> found;    ///< output: 1 = found; otherwise to_x and to_y are invalid

  std::size_t size() const { return from_x.size(); }
  void resize(std::size_t count);
};

/// Stopping and acceptance criteria of follow_points().
struct PointFlowSettings {
  int iterations = 10;      ///< at most, per level of the pyramid
  float precision = 0.05F;  ///< a step shorter than this ends the iteration [px of the level]
  float largest_difference =
      25.0F;  ///< mean absolute difference of grey levels in the window above which a point is lost
};

/// Pyramidal Lucas-Kanade optical flow of points (Bouguet, "Pyramidal implementation of the Lucas Kanade feature
/// tracker", 2000): from the coarsest level to the finest, a window of 8 x 8 pixels is moved to the minimum of the sum
/// of squared differences. A point is lost if its window lacks texture in a direction, leaves the image, or differs too
/// much. The images must have the same size. Points are independent of each other; results have the same bits on every
/// processor.
void follow_points(const ImagePyramid& from, const ImagePyramid& to, const PointFlowSettings& settings, PointFlow& flow,
                   SimdLevel simd = simd_level());

}  // namespace holdfast
