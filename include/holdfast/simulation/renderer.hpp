// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "holdfast/core/camera.hpp"
#include "holdfast/simulation/world.hpp"

namespace holdfast::simulation {

/// Images of a perfect sensor: raw (distorted), of the camera's size.
struct RenderedFrame {
  cv::Mat colour;      ///< 8UC3, blue green red; edges are anti-aliased
  cv::Mat depth;       ///< 32FC1 along the optical axis [m] at the pixel's centre; 0 = nothing
  cv::Mat object_ids;  ///< 16UC1, index into World::objects plus one, of the same surface as the depth; 0 = nothing
  cv::Mat cosine;      ///< 32FC1, between the surface normal and the direction to the camera
};

/// Renders a world in software. Static objects have baked light; moving objects are lit in each frame. Visibility is
/// computed with a z-buffer at twice the camera's resolution in the undistorted image plane (2D homogeneous
/// rasterisation; Olano and Greer 1997, which needs no clipping). Then each raw pixel is shaded once along its own ray:
/// depth and texture position are those of the ray's intersection with the surface, so that distortion requires no
/// second interpolation and depth is exact. At edges nine samples are averaged. The same input gives the same bytes.
/// Not thread-safe, because buffers are kept between frames. The world must outlive the renderer and remain unchanged.
class Renderer {
 public:
  Renderer(const World& world, const Camera& camera);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Renders a frame. `time` [s] determines the poses of moving objects.
  RenderedFrame render(const Eigen::Isometry3d& T_world_camera, double time);

  /// Renders a frame with motion blur for an exposure of `exposure` [s] around `time`: colour is the mean of sharp
  /// images at equidistant times during the exposure, each with its own poses of camera and objects; one image for
  /// every 1.5 px of the largest motion in the image, at most 16. Depth, ids and cosine are those at `time`. The image
  /// is sharp for an exposure of 0 and for smaller motion. The run time is that of this number of frames.
  RenderedFrame render(const std::function<Eigen::Isometry3d(double)>& T_world_camera, double time, double exposure);

 private:
  struct Parts;
  /// The largest motion in the image during the exposure [px].
  double image_motion(const RenderedFrame& frame, const std::function<Eigen::Isometry3d(double)>& T_world_camera,
                      double time, double exposure);

  std::unique_ptr<Parts> parts_;
};

}  // namespace holdfast::simulation
