// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <vector>

#include "cluster_scores.hpp"
#include "holdfast/depth_blocks/depth_view.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/settings/depth_clusters.hpp"
#include "k_means.hpp"

namespace holdfast::depth_clusters_plugin {

using depth_blocks::ViewMaker;

/// Classifies clusters of the depth image as static or moving, before features are matched and without a network: the
/// blocks of a small image are divided by k-means, the frame is warped into a frame a quarter of a second older with
/// the predicted pose, which is refined by depth and brightness, and clusters with large residuals are moving. Scores
/// are regularised between adjacent clusters and in time.
///
/// After Jaimez, Kerl, Gonzalez-Jimenez, Cremers: Fast Odometry and Scene Flow from RGB-D Cameras based on Geometric
/// Clustering (VO-SF), ICRA 2017, sections III and IV, and Scona, Jaimez, Petillot, Fallon, Cremers: StaticFusion, ICRA
/// 2018, section IV. Keeps images and poses of the last frames. The evidence is measurements.
class DepthClusters final : public DynamicFilter {
 public:
  DepthClusters(const DepthClustersSettings& settings, const CreationContext& context);

  Needs needs() const override { return {.depth = true, .pose_prior = true}; }
  void apply(const FilterContext& context, StaticEvidence& evidence) override;

  /// Whether evidence was added for the last frame.
  bool evaluated() const { return evaluated_; }

 private:
  void keep_up(const FilterContext& context);
  const DepthView* reference(double timestamp, const Eigen::Isometry3d& T_camera_world) const;
  void inherit(const DepthView& now, const Eigen::Isometry3d& T_camera_world);
  void add_evidence(const Frame& frame, const DepthView& now, StaticEvidence& evidence) const;

  DepthClustersSettings settings_;
  ViewMaker maker_;
  DepthNoise noise_;
  MotionCorrection correction_;
  KMeans clusters_;
  ClusterScores scores_;
  std::deque<DepthView> views_;   // oldest first; all but the last have their final pose
  std::vector<float> inherited_;  // static scores of the previous frame at the ego-motion-compensated blocks
  bool evaluated_ = false;
};

}  // namespace holdfast::depth_clusters_plugin
