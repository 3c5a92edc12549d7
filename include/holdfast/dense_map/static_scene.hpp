// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/dense_map/kept_view.hpp"
#include "holdfast/map_io/cloud_ply.hpp"

namespace holdfast {

/// Collects what keyframes show of the static scene, and makes a dense cloud of it at the end, when the poses are what
/// they will be. Memory: view_bytes() per keyframe, for DenseMapSettings::keyframes of them at most (384 kB each at
/// 640x480 and step 2); while a cloud is made, about 64 bytes per occupied voxel more. One thread.
class StaticScene {
 public:
  StaticScene(const Camera& camera, const DenseMapSettings& settings);

  /// Keeps a keyframe whose mask is settled; see ViewSampler::sample. In any order.
  void add(KeyFrameId keyframe, const SensorFrame& frame, const CoarseView& coarse, const cv::Mat& labels,
           const std::vector<bool>& left_out);

  const DenseMapSettings& settings() const { return settings_; }
  /// By rising frame index.
  const std::vector<KeptView>& views() const { return views_; }
  /// The pinhole camera of the views.
  const Camera& camera() const { return sampler_.camera(); }
  std::size_t view_bytes() const;

  /// One point per voxel that enough views saw and that stayed: in world coordinates, at the mean of what was seen in
  /// it, with the mean colour, in the order of the voxels. A view is placed where the map has its keyframe (or had it,
  /// when it was removed: Map::pose_of).
  ///
  /// A voxel goes when views that came after it was first seen look through it: at least 2 and more than half as many
  /// as saw it, or, after the last that saw it, at least 3 and more than a quarter. So what left vanishes, and what
  /// came stays.
  std::vector<CloudPoint> cloud(const Map& map) const;

 private:
  void make_room();

  DenseMapSettings settings_;
  ViewSampler sampler_;
  std::vector<KeptView> views_;
};

}  // namespace holdfast
