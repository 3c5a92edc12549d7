// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/plugin.hpp"

#include "depth_clusters.hpp"

HOLDFAST_PLUGIN(depth_clusters, registry) {
  using namespace holdfast;
  registry.add<DynamicFilter, cluster_plugin::DepthClusters, DepthClustersSettings>(
      {.name = DepthClustersSettings::module,
       .summary = "Clusters of the depth image whose residuals under the camera's motion are large move.",
       .paper = "Jaimez, Kerl, Gonzalez-Jimenez, Cremers: Fast Odometry and Scene Flow from RGB-D Cameras based on "
                "Geometric Clustering. ICRA 2017. Scona, Jaimez, Petillot, Fallon, Cremers: StaticFusion: Background "
                "Reconstruction for Dense RGB-D SLAM in Dynamic Environments. ICRA 2018"});
}
