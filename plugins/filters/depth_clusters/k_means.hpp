// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/depth_blocks/depth_view.hpp"

namespace holdfast::depth_clusters_plugin {

using depth_blocks::BlockGrid;
using depth_blocks::DepthView;

/// Divides the blocks of a view into clusters (k-means with Lloyd's iterations) by viewing direction and logarithm of
/// depth, so that distances are relative to depth. The first view starts with centres on a grid, later views with the
/// centres of the previous view. The same views give the same clusters.
class KMeans {
 public:
  static constexpr std::uint8_t none = 255;

  KMeans(int clusters, int iterations) : wanted_(clusters), iterations_(iterations) {}

  void restart() { centres_.clear(); }
  void divide(const BlockGrid& grid, const DepthView& view);

  int count() const { return static_cast<int>(centres_.size()); }
  /// Cluster of every block; `none` without depth.
  const std::vector<std::uint8_t>& cluster_of() const { return cluster_; }
  /// Blocks in each cluster.
  const std::vector<int>& sizes() const { return sizes_; }

 private:
  struct Centre {
    float x, y, log_depth;
  };
  void begin(const BlockGrid& grid);
  void assign(const BlockGrid& grid);
  void move_centres(const BlockGrid& grid);

  int wanted_, iterations_;
  std::vector<Centre> centres_;
  std::vector<float> log_depth_;
  std::vector<float> distance_;  // squared, to the centre of its cluster
  std::vector<std::uint8_t> cluster_;
  std::vector<int> sizes_;
};

}  // namespace holdfast::depth_clusters_plugin
