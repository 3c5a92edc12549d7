// SPDX-License-Identifier: BSD-3-Clause
#include "cluster_scores.hpp"

#include <algorithm>
#include <cmath>

namespace holdfast::depth_clusters_plugin {

using depth_blocks::Surface;

namespace {

constexpr float largest_shift = 6.0F, unknown_shift = 1e3F;

}  // namespace

void ClusterScores::compare(const BlockGrid& grid, const DepthView& now, const DepthView& past,
                            const Eigen::Isometry3d& T_past_now, const DepthNoise& noise) {
  const geometry::Warp warp = grid.warp(T_past_now);
  moving_.assign(now.depth.size(), 0.0F);
  stationary_.assign(now.depth.size(), 0.0F);
  shift_.assign(now.depth.size(), unknown_shift);
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t block = static_cast<std::size_t>(row * grid.columns + column);
      const float depth = now.depth[block];
      if (depth <= 0.0F) continue;
      const auto warped = grid.warped(warp, column, row, depth);
      if (!warped) continue;
      const float z = warped->point.z();
      const Surface there = surface_at(grid, past, grid.column_of(warped->x), grid.row_of(warped->y));
      if (!there.known) continue;
      // At a depth edge the pixel may belong to either surface: only a depth outside both differs.
      float residual = there.depth - z;
      if (!there.smooth) residual = z < there.nearest ? there.nearest - z : z > there.farthest ? there.farthest - z : 0;
      const float in_noise = residual / noise.at(z);
      if (there.smooth && std::abs(in_noise) < largest_shift) shift_[block] = in_noise;
      const float surely = std::clamp(0.5F * (std::abs(in_noise) - 1.0F), 0.0F, 1.0F);
      if (in_noise > 1.0F) {
        moving_[block] = surely;  // the block was free space
      } else if (in_noise < -1.0F) {
        // Farther than the earlier surface: the earlier surface moved away or occluded this one.
        constexpr float hidden = 0.2F;  // m
        moving_[block] = -residual < hidden ? 0.5F * surely : 0.0F;
      } else {
        const float certainty = there.smooth ? 1.0F : 0.3F;
        stationary_[block] = certainty * (1.0F - 0.5F * std::abs(in_noise));
        if (!there.smooth) continue;
        // Depths agree; the brightness may differ if a surface slides along itself.
        const float grey_noise = 15.0F + 0.6F * (std::abs(there.grey_x) + std::abs(there.grey_y));
        const float grey = std::abs(there.grey - now.grey[block]) / grey_noise;
        const float differs = std::clamp(grey - 1.0F, 0.0F, 1.0F);
        stationary_[block] *= 1.0F - differs;
        moving_[block] = 0.5F * differs;
      }
    }
}

float ClusterScores::support(const DepthView& now, const std::vector<float>& trust) const {
  float still = 0.0F, all = 0.0F;
  for (std::size_t i = 0; i < now.depth.size(); ++i) {
    const float weight = trust[i] * surface_of(now.depth[i]);
    still += weight * stationary_[i];
    all += weight * (stationary_[i] + moving_[i]);
  }
  return all > 0.0F ? still / all : 1.0F;
}

void ClusterScores::find_contacts(const BlockGrid& grid, const DepthView& now, const KMeans& clusters) {
  const std::size_t count = static_cast<std::size_t>(clusters.count());
  const std::vector<std::uint8_t>& cluster = clusters.cluster_of();
  contacts_.assign(count * count, 0.0F);
  const auto touch = [&](std::size_t a, std::size_t b) {
    if (cluster[a] == cluster[b] || cluster[a] == KMeans::none || cluster[b] == KMeans::none) return;
    constexpr float contrast = 0.04F;  // of the depth
    const float jump = std::abs(now.depth[a] - now.depth[b]) / (contrast * std::min(now.depth[a], now.depth[b]));
    const float goes_on = std::max(0.0F, 1.0F - jump);
    contacts_[cluster[a] * count + cluster[b]] += goes_on;
    contacts_[cluster[b] * count + cluster[a]] += goes_on;
  };
  for (int row = 0; row + 1 < grid.rows; ++row)
    for (int column = 0; column + 1 < grid.columns; ++column) {
      const std::size_t block = static_cast<std::size_t>(row * grid.columns + column);
      touch(block, block + 1);
      touch(block, block + static_cast<std::size_t>(grid.columns));
    }
}

void ClusterScores::score(const BlockGrid& grid, const DepthView& now, const KMeans& clusters,
                          const std::vector<float>& inherited, const Weights& weights) {
  const std::size_t count = static_cast<std::size_t>(clusters.count());
  const std::vector<std::uint8_t>& cluster = clusters.cluster_of();
  std::vector<float> moving(count, 0.0F), stationary(count, 0.0F), shift(count, 0.0F), shifted(count, 0.0F);
  inherited_.assign(count, 0.0F);
  for (std::size_t i = 0; i < cluster.size(); ++i) {
    if (cluster[i] == KMeans::none) continue;
    moving[cluster[i]] += moving_[i];
    stationary[cluster[i]] += stationary_[i];
    inherited_[cluster[i]] += inherited[i];
    if (shift_[i] != unknown_shift) shift[cluster[i]] += shift_[i], shifted[cluster[i]] += 1.0F;
  }
  data_.assign(count, 1.0F);
  confidence_.assign(count, 0.0F);
  for (std::size_t k = 0; k < count; ++k) {
    const float size = static_cast<float>(std::max(1, clusters.sizes()[k]));
    inherited_[k] /= size;
    const float evaluated = moving[k] + stationary[k];
    confidence_[k] = std::min(1.0F, evaluated / (0.5F * size));
    if (evaluated <= 0.0F) continue;
    constexpr float still = 0.12F, sure = 0.45F;  // moving fraction of a static and of a moving cluster
    data_[k] = 1.0F - std::clamp((moving[k] / evaluated - still) / (sure - still), 0.0F, 1.0F);
    // A shift below the noise of each block, but consistent in all blocks.
    constexpr float min_blocks = 20.0F, little = 0.5F, much = 1.2F;
    if (shifted[k] >= min_blocks)
      data_[k] = std::min(data_[k],
                          1.0F - std::clamp((std::abs(shift[k] / shifted[k]) - little) / (much - little), 0.0F, 1.0F));
  }
  find_contacts(grid, now, clusters);
  // Least squares with few unknowns by Gauss-Seidel, which converges because the matrix is strictly diagonally
  // dominant.
  scores_ = inherited_;
  for (int sweep = 0; sweep < 8; ++sweep)
    for (std::size_t k = 0; k < count; ++k) {
      float sum = confidence_[k] * data_[k] + weights.memory * inherited_[k];
      float weight = confidence_[k] + weights.memory;
      const float border = 2.0F * std::sqrt(static_cast<float>(std::max(1, clusters.sizes()[k])));
      for (std::size_t other = 0; other < count; ++other) {
        const float pull = weights.neighbours * std::min(1.0F, contacts_[k * count + other] / border);
        sum += pull * scores_[other];
        weight += pull;
      }
      scores_[k] = weight > 0.0F ? sum / weight : 1.0F;
    }
}

}  // namespace holdfast::depth_clusters_plugin
