// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <vector>

#include "cluster_scores.hpp"
#include "holdfast/depth_blocks/depth_view.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/settings/depth_clusters.hpp"
#include "k_means.hpp"

namespace holdfast::cluster_plugin {

using depth_blocks::ViewMaker;

/// Judges clusters of the depth image by what they look like under the camera's motion, before features are matched
/// and without any network: blocks of a small image are divided by k-means; the frame is carried into one a quarter of
/// a second older with the predicted pose, corrected by what the images themselves say; clusters whose depth or
/// brightness disagrees move. Scores are regularised between neighbours and in time.
///
/// After Jaimez, Kerl, Gonzalez-Jimenez, Cremers: Fast Odometry and Scene Flow from RGB-D Cameras based on Geometric
/// Clustering (VO-SF), ICRA 2017, sections III and IV, and Scona, Jaimez, Petillot, Fallon, Cremers: StaticFusion, ICRA
/// 2018, section IV. Keeps images and poses of the last frames. Statements are measurements.
class DepthClusters final : public DynamicFilter {
 public:
  DepthClusters(const DepthClustersSettings& settings, const CreationContext& context);

  Needs needs() const override { return {.depth = true, .pose_prior = true}; }
  void apply(const FilterContext& context, StaticEvidence& evidence) override;

  /// Of the last frame: whether it was judged.
  bool judged() const { return judged_; }

 private:
  void keep_up(const FilterContext& context);
  const DepthView* reference(double timestamp, const Eigen::Isometry3d& T_camera_world) const;
  void inherit(const DepthView& now, const Eigen::Isometry3d& T_camera_world);
  void say(const Frame& frame, const DepthView& now, StaticEvidence& evidence) const;

  DepthClustersSettings settings_;
  ViewMaker maker_;
  DepthNoise noise_;
  MotionCorrection correction_;
  KMeans clusters_;
  ClusterScores scores_;
  std::deque<DepthView> views_;   // oldest first; all but the last have their final pose
  std::vector<float> inherited_;  // static scores of the frame before, where the blocks were then
  bool judged_ = false;
};

}  // namespace holdfast::cluster_plugin
