// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>

#include "holdfast/core/simd.hpp"

namespace holdfast {

inline constexpr int max_patch_radius = 15;  ///< [px]
inline constexpr int max_patch_shifts = 32;  ///< columns to which a patch is compared

/// A square patch of the left image, and the patches of the right image that it is compared with: from `first` on, one
/// for each column.
struct PatchSearch {
  int x, y;    ///< centre in the left image [px]
  int radius;  ///< 1 to max_patch_radius
  int first;   ///< column of the first centre in the right image [px]
  int shifts;  ///< 1 to max_patch_shifts
  float top;   ///< upper row of the patches in the right image [px]; between two rows both are interpolated, in 1/64
};

/// Sums of absolute differences between a patch and those of the right image, the first `shifts` of the result. The
/// mean difference, rounded to zero, is subtracted: it is one of exposure. All patches, and a row below the
/// interpolated ones, must lie inside the images (8UC1). Equal at every SIMD level.
void compare_patches(const cv::Mat& left, const cv::Mat& right, const PatchSearch& search,
                     std::array<int, max_patch_shifts>& costs, SimdLevel level = simd_level());

}  // namespace holdfast
