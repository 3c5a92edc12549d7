// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class DynamicFilter;
template <class Settings>
class ParameterTable;

/// Settings of the filter `depth_clusters`. Ranges and units: `holdfast modules depth_clusters`.
struct DepthClustersSettings {
  using Interface = DynamicFilter;
  static constexpr const char* module = "depth_clusters";

  int clusters = 24;  ///< number of k-means clusters of the depth image; about 24 in Jaimez et al. 2017
  /// K-means iterations per frame; few suffice, because they start from the clusters of the previous frame.
  int iterations = 2;
  double interval = 0.25;  ///< maximum age of the reference image [s]; a longer interval reveals slower motion
  double noise = 0.008;    ///< depth noise at depth zero [m]; differences below the noise count as the same surface
  double noise_growth = 0.004;  ///< quadratic growth of the depth noise: noise + noise_growth * depth^2 [1/m]
  double neighbours = 0.5;      ///< weight of the smoothness term between adjacent clusters; 0 = independent clusters
  double memory = 1.0;          ///< weight of the temporal term with the previous frame; 0 = no temporal term
  /// Minimum fraction of the trusted surface that must be static; below it the pose may be wrong, and the filter
  /// adds no evidence.
  double support = 0.5;
  /// Maximum correction of the predicted pose [m], and twice this value in radians; 0 = no correction.
  double correction = 0.1;
  double moving_log_odds = -4.0;  ///< evidence of a cluster with static score 0
  double static_log_odds = 0.5;   ///< evidence of a cluster with static score 1

  static void describe(ParameterTable<DepthClustersSettings>& table);
};

}  // namespace holdfast
