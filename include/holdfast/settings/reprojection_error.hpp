// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class DynamicFilter;
template <class Settings>
class ParameterTable;

/// Settings of the filter `reprojection_error`. Ranges and units: `holdfast modules reprojection_error`.
/// The defaults are cautious, because the pose depends on the matches that are tested: -4, 0.3 and a support of 0.5
/// were worse on recordings with composed people (plugins/filters/reprojection_error/README.md).
struct ReprojectionErrorSettings {
  using Interface = DynamicFilter;
  static constexpr const char* module = "reprojection_error";

  /// Of the squared normalised residual without depth: chi-square 95 %, two degrees of freedom.
  double threshold = 5.991;
  double threshold_depth = 7.815;  ///< the same with depth: chi-square 95 %, three degrees of freedom
  int frames = 3;  ///< number of failures among the last eight observations of a map point that give full evidence
  /// Minimum fraction of the trusted matches that must pass the test; below it the pose may be wrong, and the
  /// filter adds no evidence.
  double support = 0.85;
  int minimum_matches = 30;           ///< minimum number of trusted matches; below it the filter adds no evidence
  double minimum_found_ratio = 0.35;  ///< found ratio below which a map point is unstable
  /// Ratio of the length of the mean displacement to the mean length from which on displacements agree; 1 = all
  /// parallel.
  double agreement = 0.7;
  /// Whether evidence grows with the number of failures and the size of the error, and is halved where displacements do
  /// not agree. Without it, a match that fails has all the evidence once its point failed in `frames` observations or
  /// is unstable, and none before: the decision of Zeng et al. 2023.
  bool soften = true;
  double moving_log_odds = -1.0;  ///< evidence of a match with a large and persistent error
  double static_log_odds = 0.0;   ///< evidence of a match that passes

  static void describe(ParameterTable<ReprojectionErrorSettings>& table);
};

}  // namespace holdfast
