// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class FeatureExtractor;
template <class Settings>
class ParameterTable;

/// Settings of the feature extractor `orb`. Ranges and units: `holdfast modules orb`.
/// Thread: any.
struct OrbSettings {
  using Interface = FeatureExtractor;
  static constexpr const char* module = "orb";

  int count = 1000;            ///< number of features to extract; 1000 as in ORB-SLAM2 for RGB-D
  int levels = 8;              ///< number of pyramid levels, as in ORB-SLAM2
  double scale_factor = 1.2;   ///< scale between adjacent pyramid levels, as in ORB-SLAM2
  int fast_threshold = 20;     ///< minimum contrast of a FAST corner [grey level], as in ORB-SLAM2
  int fast_threshold_low = 7;  ///< fallback threshold of cells without a corner [grey level], as in ORB-SLAM2
  int cell_size = 32;          ///< side of these cells [px of the level]
  /// Fraction of the features that is selected for even coverage; the rest is selected by response. Trade-off
  /// between coverage and number of matches, measured in plugins/features/orb/README.md.
  double spread = 0.4;
  /// Whether positions are refined to sub-pixel accuracy; lowers the residual from 0.90 to 0.53 px (same README).
  bool subpixel = true;

  static void describe(ParameterTable<OrbSettings>& table);
};

}  // namespace holdfast
