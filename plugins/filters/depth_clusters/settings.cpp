// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/depth_clusters.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void DepthClustersSettings::describe(ParameterTable<DepthClustersSettings>& table) {
  using S = DepthClustersSettings;
  table.add("clusters", &S::clusters, "number of k-means clusters of the depth image").range(4, 64);
  table
      .add("iterations", &S::iterations,
           "k-means iterations per frame, starting from the clusters of the previous frame")
      .range(1, 20);
  table.add("interval", &S::interval, "maximum age of the reference image; a longer interval reveals slower motion")
      .range(0.03, 2)
      .unit("s");
  table.add("noise", &S::noise, "depth noise at depth zero: noise + noise_growth * depth^2").range(0.001, 1).unit("m");
  table.add("noise_growth", &S::noise_growth, "quadratic growth of the depth noise").range(0, 1).unit("1/m");
  table
      .add("neighbours", &S::neighbours,
           "weight of the smoothness term between adjacent clusters; 0 = independent clusters")
      .range(0, 100);
  table.add("memory", &S::memory, "weight of the temporal term with the previous frame; 0 = none").range(0, 100);
  table
      .add(
          "support", &S::support,
          "minimum fraction of the trusted surface that must be static; below it the pose may be wrong, and the filter "
          "adds no evidence")
      .range(0, 1);
  table
      .add("correction", &S::correction,
           "maximum correction of the predicted pose, and twice this value in radians; 0 = none")
      .range(0, 1)
      .unit("m");
  table.add("moving_log_odds", &S::moving_log_odds, "evidence of clusters that certainly move").range(-20, 0);
  table.add("static_log_odds", &S::static_log_odds, "evidence of clusters that are certainly static").range(0, 20);
}

}  // namespace holdfast
