// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class FeatureExtractor;
template <class Settings>
class ParameterTable;

/// Settings of the feature extractor `opencv_orb`. Ranges and units: `holdfast modules opencv_orb`.
struct OpencvOrbSettings {
  using Interface = FeatureExtractor;
  static constexpr const char* module = "opencv_orb";

  int count = 1000;           ///< number of features to extract; 1000 as in ORB-SLAM2 for RGB-D
  double scale_factor = 1.2;  ///< scale between adjacent pyramid levels, as in ORB-SLAM2
  int levels = 8;             ///< number of pyramid levels, as in ORB-SLAM2
  int fast_threshold = 20;    ///< minimum contrast of a FAST corner [grey level], as in ORB-SLAM2

  static void describe(ParameterTable<OpencvOrbSettings>& table);
};

}  // namespace holdfast
