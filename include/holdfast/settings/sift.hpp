// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class FeatureExtractor;
template <class Settings>
class ParameterTable;

/// Settings of the feature extractor `sift`. Ranges and units: `holdfast modules sift`.
/// Thread: any.
struct SiftSettings {
  using Interface = FeatureExtractor;
  static constexpr const char* module = "sift";

  int count = 1000;                  ///< number of features to extract; the strongest are kept
  int octave_layers = 3;             ///< layers per octave of the scale space, as in Lowe 2004
  double contrast_threshold = 0.02;  ///< minimum contrast; half of Lowe's, because rooms have weak texture
  double edge_threshold = 10.0;      ///< maximum ratio of principal curvatures, as in Lowe 2004
  double strict_distance = 200.0;    ///< recommended for matches without a prediction
  double loose_distance = 300.0;     ///< recommended for matches near their prediction

  static void describe(ParameterTable<SiftSettings>& table);
};

}  // namespace holdfast
