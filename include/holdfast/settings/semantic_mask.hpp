// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace holdfast {

class DynamicFilter;
template <class Settings>
class ParameterTable;

/// The filter `semantic_mask`: what each value means, and its range, is in the reference (`holdfast modules
/// semantic_mask`).
struct SemanticMaskSettings {
  using Interface = DynamicFilter;
  static constexpr const char* module = "semantic_mask";

  std::vector<std::string> classes;
  int dilate = 10;
  int edge = 4;
  double depth_margin = 0.15;
  double movable_log_odds = -4.0;
  double background_log_odds = 0.5;

  static void describe(ParameterTable<SemanticMaskSettings>& table);
};

}  // namespace holdfast
