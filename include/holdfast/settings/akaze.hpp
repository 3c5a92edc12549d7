// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class FeatureExtractor;
template <class Settings>
class ParameterTable;

/// Settings of the feature extractor `akaze`. Ranges and units: `holdfast modules akaze`.
/// Thread: any.
struct AkazeSettings {
  using Interface = FeatureExtractor;
  static constexpr const char* module = "akaze";

  int count = 1000;             ///< number of features to extract; the strongest are kept
  int octaves = 4;              ///< of the scale space
  int octave_layers = 4;        ///< layers per octave
  double threshold = 0.0003;    ///< minimum response; a third of OpenCV's default, because rooms have weak texture
  double strict_distance = 80;  ///< recommended for matches without a prediction [bits of 486]
  double loose_distance = 140;  ///< recommended for matches near their prediction [bits of 486]

  static void describe(ParameterTable<AkazeSettings>& table);
};

}  // namespace holdfast
