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

/// A keyframe's picture, and the same with the static scene in the place of what moves.
struct BackgroundPicture {
  cv::Mat before;         ///< 8UC3, black where the undistorted image shows nothing
  cv::Mat after;          ///< 8UC4: alpha 255, or 0 (and magenta) where no keyframe has seen the background
  double replaced = 0.0;  ///< share of the pixels that came from other keyframes
  double unknown = 0.0;   ///< share of the pixels that nobody knows
};

/// Fills what moves in keyframes' pictures with what other keyframes saw behind it: their static pixels with depth are
/// projected into the view, the nearest surface wins (z-buffer), and of several views of one surface the one that is
/// most alike in direction, place and time. Pixels whose voxel has left (StaticScene::cloud) count as moving, in the
/// view and in the others; what would lie in front of what is to be replaced is not used. Cracks between projected
/// pixels are closed.
class BackgroundPainter {
 public:
  /// The scene must outlive the painter; the poses are those that the map has now.
  BackgroundPainter(const StaticScene& scene, const Map& map);
  ~BackgroundPainter();

  /// Of scene.views()[view].
  BackgroundPicture paint(std::size_t view) const;

 private:
  struct Canvas;
  void project(std::size_t from, std::size_t into, Canvas& canvas) const;

  const StaticScene& scene_;
  std::vector<Eigen::Isometry3d> T_world_camera_;
  enum Use : std::uint8_t { as_it_is, source, replaced };
  std::vector<cv::Mat> uses_;  // per view: 8UC1, what each pixel is good for; a source also stays as it is
};

}  // namespace holdfast
