// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class DynamicFilter;
template <class Settings>
class ParameterTable;

/// The filter `depth_clusters`: what each value means, and its range, is in the reference (`holdfast modules
/// depth_clusters`).
struct DepthClustersSettings {
  using Interface = DynamicFilter;
  static constexpr const char* module = "depth_clusters";

  int clusters = 24;
  int iterations = 2;
  double interval = 0.25;
  double noise = 0.008;
  double noise_growth = 0.004;
  double neighbours = 0.5;
  double memory = 1.0;
  double support = 0.5;
  double correction = 0.1;
  double moving_log_odds = -4.0;
  double static_log_odds = 0.5;

  static void describe(ParameterTable<DepthClustersSettings>& table);
};

}  // namespace holdfast
