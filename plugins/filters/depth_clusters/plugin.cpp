// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/plugin.hpp"

#include "depth_clusters.hpp"

HOLDFAST_PLUGIN(depth_clusters, registry) {
  using namespace holdfast;
  registry.add<DynamicFilter, depth_clusters_plugin::DepthClusters, DepthClustersSettings>(
      {.name = DepthClustersSettings::module,
       .summary = "Evidence against clusters of the depth image with large residuals under the camera's motion.",
       .paper = "Jaimez, Kerl, Gonzalez-Jimenez, Cremers: Fast Odometry and Scene Flow from RGB-D Cameras based on "
                "Geometric Clustering. ICRA 2017. Scona, Jaimez, Petillot, Fallon, Cremers: StaticFusion: Background "
                "Reconstruction for Dense RGB-D SLAM in Dynamic Environments. ICRA 2018"});
}
