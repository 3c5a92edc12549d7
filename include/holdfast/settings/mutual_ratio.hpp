// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class FeatureMatcher;
template <class Settings>
class ParameterTable;

/// Settings of the matcher `mutual_ratio`. Ranges and units: `holdfast modules mutual_ratio`.
/// Thread: any.
struct MutualRatioSettings {
  using Interface = FeatureMatcher;
  static constexpr const char* module = "mutual_ratio";

  double ratio = 0.8;  ///< largest quotient of the smallest and the second smallest distance (Lowe 2004)
  /// Factor on the largest distance that the caller accepts; it weakens the limits of an extractor whose recommended
  /// distances are uncertain, so that the quotient decides.
  double distance_factor = 1.0;

  static void describe(ParameterTable<MutualRatioSettings>& table);
};

}  // namespace holdfast
