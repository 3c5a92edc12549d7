// SPDX-License-Identifier: BSD-3-Clause
#include "k_means.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace holdfast::depth_clusters_plugin {

namespace {

constexpr float depth_weight = 2.0F;  // clusters are divided at depth steps rather than along a surface
constexpr float no_depth = -1e3F;     // in place of the logarithm
constexpr int smallest_cluster = 8;   // blocks
constexpr float far_away = std::numeric_limits<float>::max();

}  // namespace

void KMeans::begin(const BlockGrid& grid) {
  centres_.clear();
  const int across = std::max(1, static_cast<int>(std::lround(std::sqrt(wanted_ * 4.0 / 3.0))));
  for (int k = 0; k < wanted_; ++k) {
    const int down = (wanted_ + across - 1) / across;
    const int left = (k % across) * grid.columns / across, right = (k % across + 1) * grid.columns / across;
    const int top = (k / across) * grid.rows / down, bottom = (k / across + 1) * grid.rows / down;
    Centre sum{0, 0, 0};
    int count = 0;
    for (int row = top; row < bottom; ++row)
      for (int column = left; column < right; ++column) {
        const float value = log_depth_[static_cast<std::size_t>(row * grid.columns + column)];
        if (value == no_depth) continue;
        sum.x += grid.ray_x[static_cast<std::size_t>(column)];
        sum.y += grid.ray_y[static_cast<std::size_t>(row)];
        sum.log_depth += value;
        ++count;
      }
    if (count == 0) continue;
    const float inverse = 1.0F / static_cast<float>(count);
    centres_.push_back({sum.x * inverse, sum.y * inverse, sum.log_depth * inverse});
  }
}

void KMeans::assign(const BlockGrid& grid) {
  std::fill(distance_.begin(), distance_.end(), far_away);
  std::fill(cluster_.begin(), cluster_.end(), none);
  for (std::size_t k = 0; k < centres_.size(); ++k) {
    const Centre centre = centres_[k];
    const auto name = static_cast<std::uint8_t>(k);
    for (int row = 0; row < grid.rows; ++row) {
      const float dy = grid.ray_y[static_cast<std::size_t>(row)] - centre.y;
      const float dy2 = dy * dy;
      const std::size_t first = static_cast<std::size_t>(row * grid.columns);
      const float* log_depth = log_depth_.data() + first;
      const float* ray_x = grid.ray_x.data();
      float* best = distance_.data() + first;
      std::uint8_t* cluster = cluster_.data() + first;
      for (int column = 0; column < grid.columns; ++column) {
        const float dx = ray_x[column] - centre.x, dz = depth_weight * (log_depth[column] - centre.log_depth);
        const float distance = dx * dx + dy2 + dz * dz;
        const bool nearer = distance < best[column];
        best[column] = nearer ? distance : best[column];
        cluster[column] = nearer ? name : cluster[column];
      }
    }
  }
  sizes_.assign(centres_.size(), 0);
  for (std::size_t i = 0; i < cluster_.size(); ++i) {
    if (log_depth_[i] == no_depth)
      cluster_[i] = none, distance_[i] = 0.0F;
    else
      ++sizes_[cluster_[i]];
  }
}

void KMeans::move_centres(const BlockGrid& grid) {
  std::vector<Centre> sums(centres_.size(), Centre{0, 0, 0});
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t i = static_cast<std::size_t>(row * grid.columns + column);
      if (cluster_[i] == none) continue;
      Centre& sum = sums[cluster_[i]];
      sum.x += grid.ray_x[static_cast<std::size_t>(column)];
      sum.y += grid.ray_y[static_cast<std::size_t>(row)];
      sum.log_depth += log_depth_[i];
    }
  for (std::size_t k = 0; k < centres_.size(); ++k) {
    if (sizes_[k] >= smallest_cluster) {
      const float inverse = 1.0F / static_cast<float>(sizes_[k]);
      centres_[k] = {sums[k].x * inverse, sums[k].y * inverse, sums[k].log_depth * inverse};
      continue;
    }
    // A cluster that is too small is re-initialised where the clusters fit worst.
    const auto worst = std::max_element(distance_.begin(), distance_.end());
    const int block = static_cast<int>(worst - distance_.begin());
    centres_[k] = {grid.ray_x[static_cast<std::size_t>(block % grid.columns)],
                   grid.ray_y[static_cast<std::size_t>(block / grid.columns)],
                   log_depth_[static_cast<std::size_t>(block)]};
    *worst = 0.0F;
  }
}

void KMeans::divide(const BlockGrid& grid, const DepthView& view) {
  const std::size_t size = view.depth.size();
  log_depth_.resize(size);
  distance_.resize(size);
  cluster_.resize(size);
  bool any = false;
  for (std::size_t i = 0; i < size; ++i) {
    any = any || view.depth[i] > 0.0F;
    log_depth_[i] = view.depth[i] > 0.0F ? std::log(view.depth[i]) : no_depth;
  }
  if (!any) {
    centres_.clear();
    sizes_.clear();
    std::fill(cluster_.begin(), cluster_.end(), none);
    return;
  }
  if (centres_.empty()) begin(grid);
  for (int i = 0; i < iterations_; ++i) {
    assign(grid);
    move_centres(grid);
  }
  assign(grid);
}

}  // namespace holdfast::depth_clusters_plugin
