// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/dense_map/static_scene.hpp"

namespace holdfast {

/// The image of a keyframe, and the same image with dynamic pixels replaced by the static background.
struct BackgroundPicture {
  cv::Mat before;         ///< 8UC3, black outside the undistorted image
  cv::Mat after;          ///< 8UC4: alpha 255, or 0 (and magenta) where no keyframe observed the background
  double replaced = 0.0;  ///< fraction of pixels from other keyframes
  double unknown = 0.0;   ///< fraction of pixels without a known background
};

/// Replaces dynamic pixels of keyframe images by the background that other keyframes observed: the static pixels of
/// other keyframes with depth are projected into the view with a z-buffer, and among several views of one surface the
/// most similar one in direction, position and time is used. Pixels of removed voxels (StaticScene::cloud) count as
/// dynamic in all views. Surfaces in front of the replaced pixels are not used. Gaps between projected pixels are
/// filled.
class BackgroundPainter {
 public:
  /// The scene must outlive the painter. The current poses of the map are used.
  BackgroundPainter(const StaticScene& scene, const Map& map);
  ~BackgroundPainter();

  /// Renders the background of scene.views()[view].
  BackgroundPicture paint(std::size_t view) const;

 private:
  struct Canvas;
  void project(std::size_t from, std::size_t into, Canvas& canvas) const;

  const StaticScene& scene_;
  std::vector<Eigen::Isometry3d> T_world_camera_;
  enum Use : std::uint8_t { as_it_is, source, replaced };
  std::vector<cv::Mat> uses_;  // per view: 8UC1, Use of each pixel; source pixels are kept as well
};

}  // namespace holdfast
