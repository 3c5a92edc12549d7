// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class DynamicFilter;
template <class Settings>
class ParameterTable;

/// The filter `epipolar_consistency`: what each value means, and its range, is in the reference (`holdfast modules
/// epipolar_consistency`).
struct EpipolarConsistencySettings {
  using Interface = DynamicFilter;
  static constexpr const char* module = "epipolar_consistency";

  double threshold = 1.5;
  double parallax = 0.7;
  double parallax_share = 0.35;
  double support = 0.5;
  int gap = 3;
  int features = 500;
  double moving = 2.0;
  double fixed = 0.1;

  static void describe(ParameterTable<EpipolarConsistencySettings>& table);
};

}  // namespace holdfast
