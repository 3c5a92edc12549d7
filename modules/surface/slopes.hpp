// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "view_image.hpp"

namespace holdfast::surface {

/// Sets Pixel::slope and Pixel::weight by the normals of the surface: from the depths of four pixels around, or of the
/// centre in place of those that are no continuation of it. `depths` (32FC1, [m]) includes dynamic pixels; `rays_x` and
/// `rays_y` are those of its columns and rows at depth 1. The same result at every SimdLevel.
void set_slopes(const cv::Mat& depths, const std::vector<float>& rays_x, const std::vector<float>& rays_y,
                ViewImage::Pixel* pixels);

}  // namespace holdfast::surface
