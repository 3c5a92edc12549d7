// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class DynamicFilter;
template <class Settings>
class ParameterTable;

/// Settings of the filter `epipolar_consistency`. Ranges and units: `holdfast modules epipolar_consistency`.
struct EpipolarConsistencySettings {
  using Interface = DynamicFilter;
  static constexpr const char* module = "epipolar_consistency";

  /// Distance from the epipolar line above which a feature is moving [px]; about 1 px in DS-SLAM.
  double threshold = 1.5;
  double parallax = 0.7;  ///< residual of the best homography above which a feature has parallax [px]
  /// Minimum fraction of the inliers with parallax; below it the epipolar geometry is degenerate, and the filter
  /// adds no evidence.
  double parallax_share = 0.35;
  double support = 0.5;  ///< minimum inlier fraction of the trusted features; below it the filter adds no evidence
  int gap = 3;           ///< number of frames back to the reference image; a larger gap gives more baseline
  /// Maximum number of features that are tracked by optical flow; the run time is proportional to it.
  int features = 500;
  double moving = 2.0;  ///< subtracted from the log-odds of a feature that violates the epipolar constraint
  /// Added to the log-odds of a feature that satisfies it (YAML key `static`); weak, because motion along the
  /// epipolar line satisfies it as well.
  double fixed = 0.1;

  static void describe(ParameterTable<EpipolarConsistencySettings>& table);
};

}  // namespace holdfast
