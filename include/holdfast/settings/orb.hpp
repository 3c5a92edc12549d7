// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class FeatureExtractor;
template <class Settings>
class ParameterTable;

/// The feature extractor `orb`: what each value means, and its range, is in the reference (`holdfast modules orb`).
/// Thread: any.
struct OrbSettings {
  using Interface = FeatureExtractor;
  static constexpr const char* module = "orb";

  int count = 1000;
  int levels = 8;
  double scale_factor = 1.2;
  int fast_threshold = 20;
  int fast_threshold_low = 7;
  int cell_size = 32;
  double spread = 0.4;
  bool subpixel = true;

  static void describe(ParameterTable<OrbSettings>& table);
};

}  // namespace holdfast
