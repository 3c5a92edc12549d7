// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/dense_map/kept_view.hpp"
#include "holdfast/map_io/cloud_ply.hpp"

namespace holdfast {

/// Collects the images of keyframes and fuses their static pixels to a dense cloud at the end of the run, when the
/// poses are final. Memory: view_bytes() per keyframe for at most DenseMapSettings::keyframes keyframes (384 kB each at
/// 640x480 and step 2, 461 kB with labels), and about 64 bytes per occupied voxel during the fusion. Used by one
/// thread.
class StaticScene {
 public:
  /// `keeps_labels`: see ViewSampler.
  StaticScene(const Camera& camera, const DenseMapSettings& settings, bool keeps_labels = false);

  /// Adds a keyframe whose mask is final; see ViewSampler::sample. Keyframes may be added in any order. The kept view
  /// is valid until the next call.
  const KeptView& add(KeyFrameId keyframe, const SensorFrame& frame, const CoarseView& coarse, const cv::Mat& labels,
                      const std::vector<bool>& left_out);

  /// Removes the views of keyframes that were removed with their submap and have no pose any more.
  void forget_removed(const Map& map);

  const DenseMapSettings& settings() const { return settings_; }
  /// The kept views by increasing frame index.
  const std::vector<KeptView>& views() const { return views_; }
  /// The pinhole camera of the views.
  const Camera& camera() const { return sampler_.camera(); }
  /// Memory of a kept view: colour, depth, and the label of each pixel if they are kept.
  std::size_t view_bytes() const;
  const ViewSampler& sampler() const { return sampler_; }

  /// Static points of a kept view up to DenseMapSettings::maximum_depth, in the frame of its camera [m]: those of the
  /// finest regular grid of pixels with at most `max_count` pixels.
  std::vector<CloudPoint> surface(const KeptView& view, std::size_t max_count) const;

  /// The fused cloud in world coordinates: one point per occupied voxel, at the mean position and with the mean colour
  /// of its pixels, in voxel order. A voxel needs minimum_views views and must not be removed. The pose of a view is
  /// that of its keyframe in the map (Map::pose_of, also for removed keyframes).
  ///
  /// A voxel is removed if views after its first observation see through it: at least 2 and more than half the number
  /// of its observations; or after its last observation at least 3 and more than a quarter. Surfaces that disappeared
  /// are thus removed, and surfaces that appeared during the run are kept.
  std::vector<CloudPoint> cloud(const Map& map) const;

 private:
  void make_room();

  DenseMapSettings settings_;
  ViewSampler sampler_;
  std::vector<KeptView> views_;
};

}  // namespace holdfast
