// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace holdfast {

class DynamicFilter;
template <class Settings>
class ParameterTable;

/// Settings of the filter `semantic_mask`. Ranges and units: `holdfast modules semantic_mask`.
struct SemanticMaskSettings {
  using Interface = DynamicFilter;
  static constexpr const char* module = "semantic_mask";

  /// Names of movable classes; empty = Segmenter::movable(), or `person` if the segmenter does not specify it.
  std::vector<std::string> classes;
  /// How much some classes move, 0 to 1: 1 as those of `classes`, 0 as the background, between them classes that move
  /// seldom. Takes precedence over `classes`.
  std::vector<std::pair<std::string, double>> movable;
  int dilate = 10;  ///< features within this distance of a mask belong to it unless their depth is behind it [px]
  int edge = 4;     ///< features within this distance belong to the mask for any depth [px]
  double depth_margin = 0.15;        ///< depth difference from which on a feature is behind the adjacent mask [m]
  double movable_log_odds = -4.0;    ///< prior of a feature on a mask, times the confidence of the mask
  double background_log_odds = 0.5;  ///< prior of all other features, times the confidence of the mask

  static void describe(ParameterTable<SemanticMaskSettings>& table);
};

}  // namespace holdfast
