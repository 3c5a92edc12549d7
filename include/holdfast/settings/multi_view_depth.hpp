// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class DynamicFilter;
template <class Settings>
class ParameterTable;

/// The filter `multi_view_depth`: what each value means, and its range, is in the reference (`holdfast modules
/// multi_view_depth`).
struct MultiViewDepthSettings {
  using Interface = DynamicFilter;
  static constexpr const char* module = "multi_view_depth";

  int keyframes = 8;
  int point_keyframes = 3;
  double reach = 1.0;
  double margin = 0.06;
  double margin_slope = 0.03;
  double sure = 0.7;
  int growth = 12;
  double moving_log_odds = -4.0;
  double static_log_odds = 1.0;
  double edge = 4.0;
  double edge_log_odds = -3.0;
  double crowd_log_odds = -5.0;

  static void describe(ParameterTable<MultiViewDepthSettings>& table);
};

}  // namespace holdfast
