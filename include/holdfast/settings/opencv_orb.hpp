// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class FeatureExtractor;
template <class Settings>
class ParameterTable;

/// The feature extractor `opencv_orb`: what each value means, and its range, is in the reference (`holdfast modules
/// opencv_orb`).
struct OpencvOrbSettings {
  using Interface = FeatureExtractor;
  static constexpr const char* module = "opencv_orb";

  int count = 1000;
  double scale_factor = 1.2;
  int levels = 8;
  int fast_threshold = 20;

  static void describe(ParameterTable<OpencvOrbSettings>& table);
};

}  // namespace holdfast
