// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/depth_clusters.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void DepthClustersSettings::describe(ParameterTable<DepthClustersSettings>& table) {
  using S = DepthClustersSettings;
  table.add("clusters", &S::clusters, "into which the depth image is divided").range(4, 64);
  table.add("iterations", &S::iterations, "of k-means in each frame, from the clusters of the last one").range(1, 20);
  table.add("interval", &S::interval, "age of the image that a frame is compared with: longer shows slower movements")
      .range(0.03, 2)
      .unit("s");
  table.add("noise", &S::noise, "a depth that differs by less is the same; see noise_growth").range(0.001, 1).unit("m");
  table.add("noise_growth", &S::noise_growth, "noise grows by this much, times the square of the depth")
      .range(0, 1)
      .unit("1/m");
  table.add("neighbours", &S::neighbours, "how much clusters that touch agree; 0 = each for itself").range(0, 100);
  table.add("memory", &S::memory, "how much a cluster agrees with what was there a frame before; 0 = not at all")
      .range(0, 100);
  table
      .add("support", &S::support,
           "share of the trusted surface that must stand still; with less the pose itself may be wrong and nothing "
           "is said")
      .range(0, 1);
  table.add("correction", &S::correction, "the predicted pose is corrected by this much at most; 0 = not at all")
      .range(0, 1)
      .unit("m");
  table.add("moving_log_odds", &S::moving_log_odds, "said of what moves for certain").range(-20, 0);
  table.add("static_log_odds", &S::static_log_odds, "said of what stands still for certain").range(0, 20);
}

}  // namespace holdfast
