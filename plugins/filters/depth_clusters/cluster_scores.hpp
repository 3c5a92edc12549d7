// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/depth_blocks/depth_view.hpp"
#include "k_means.hpp"
#include "motion_correction.hpp"

namespace holdfast::depth_clusters_plugin {

/// Motion evidence of blocks and clusters from the comparison of a frame with an earlier one.
class ClusterScores {
 public:
  struct Weights {
    float neighbours;  ///< weight of the smoothness term between adjacent clusters
    float memory;      ///< weight of the temporal term
  };

  /// Compares the blocks of `now` with `past` under T_past_now and computes for each block the certainty that it moves
  /// and the certainty that it is static.
  void compare(const BlockGrid& grid, const DepthView& now, const DepthView& past, const Eigen::Isometry3d& T_past_now,
               const DepthNoise& noise);
  /// Static fraction of the trusted and comparable surface; 1 if no surface is comparable.
  float support(const DepthView& now, const std::vector<float>& trust) const;
  /// Static score of every cluster, in [0, 1], by least squares as in Jaimez et al. 2017, equation 12 and following: a
  /// data term from the residuals, a smoothness term between adjacent clusters, and a temporal term with the mean of
  /// `inherited` over the blocks of the cluster.
  void score(const BlockGrid& grid, const DepthView& now, const KMeans& clusters, const std::vector<float>& inherited,
             const Weights& weights);

  /// By block: certainty that it moves, and that it is static; both are 0 if it is not comparable.
  const std::vector<float>& moving() const { return moving_; }
  const std::vector<float>& stationary() const { return stationary_; }
  /// By cluster: static score (1 = static, 0 = moving), and comparable fraction.
  const std::vector<float>& scores() const { return scores_; }
  const std::vector<float>& confidence() const { return confidence_; }

 private:
  void find_contacts(const BlockGrid& grid, const DepthView& now, const KMeans& clusters);

  std::vector<float> moving_, stationary_, shift_;
  std::vector<float> scores_, confidence_, data_, inherited_;
  std::vector<float> contacts_;  // matrix: length of the border of two clusters with continuous depth [blocks]
};

}  // namespace holdfast::depth_clusters_plugin
