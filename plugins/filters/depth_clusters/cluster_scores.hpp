// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/depth_blocks/depth_view.hpp"
#include "k_means.hpp"
#include "motion_correction.hpp"

namespace holdfast::cluster_plugin {

/// What comparing a frame with an earlier one says of its blocks, and of clusters of them.
class ClusterScores {
 public:
  struct Weights {
    float neighbours;  ///< pull between clusters that touch
    float memory;      ///< pull towards the inherited score
  };

  /// Compares the blocks of `now` with `past` under T_past_now: says of each block how surely it moves and how surely
  /// it stands still.
  void compare(const BlockGrid& grid, const DepthView& now, const DepthView& past, const Eigen::Isometry3d& T_past_now,
               const DepthNoise& noise);
  /// Share, by surface, of what can be judged and is trusted that stands still; 1 when nothing can be judged.
  float support(const DepthView& now, const std::vector<float>& trust) const;
  /// Static score of every cluster, in [0, 1]: the least squares of Jaimez et al. 2017, equation 12 and on - each
  /// cluster near what its residuals say, near its neighbours where they touch, and near what it inherits (the mean of
  /// `inherited` over its blocks).
  void score(const BlockGrid& grid, const DepthView& now, const KMeans& clusters, const std::vector<float>& inherited,
             const Weights& weights);

  /// By block: how surely it moves, or stands still; both 0 = cannot be judged.
  const std::vector<float>& moving() const { return moving_; }
  const std::vector<float>& standing() const { return standing_; }
  /// By cluster: 1 = stands still, 0 = moves; and how much of it could be judged.
  const std::vector<float>& scores() const { return scores_; }
  const std::vector<float>& confidence() const { return confidence_; }

 private:
  void find_contacts(const BlockGrid& grid, const DepthView& now, const KMeans& clusters);

  std::vector<float> moving_, standing_, shift_;
  std::vector<float> scores_, confidence_, data_, inherited_;
  std::vector<float> contacts_;  // matrix: length of the border of two clusters where depth goes on [blocks]
};

}  // namespace holdfast::cluster_plugin
