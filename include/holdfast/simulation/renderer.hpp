// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "holdfast/core/camera.hpp"
#include "holdfast/simulation/world.hpp"

namespace holdfast::simulation {

/// What a perfect sensor sees, as raw (distorted) images of the camera's size.
struct RenderedFrame {
  cv::Mat colour;      ///< 8UC3, blue green red; edges are smoothed over a pixel
  cv::Mat depth;       ///< 32FC1 along the optical axis [m] of what lies in the pixel's centre; 0 = nothing
  cv::Mat object_ids;  ///< 16UC1, index into World::objects plus one, of the same surface as the depth; 0 = nothing
  cv::Mat cosine;      ///< 32FC1, between the surface normal and the direction to the camera
};

/// Draws a world in software: what stands still with the light baked into it, what moves lit anew in each frame.
/// Visibility is found with a z-buffer at twice the camera's resolution in the undistorted image plane (2D homogeneous
/// rasterisation; Olano and Greer 1997, so nothing needs clipping). Then each raw pixel is shaded once along its own
/// ray: depth and texture position are those of the ray's intersection with the surface, so distortion costs no second
/// interpolation and depth is exact. At edges nine samples are weighed. Same input, same bytes. Not thread-safe:
/// buffers are kept between frames. The world must outlive the renderer and stay unchanged.
class Renderer {
 public:
  Renderer(const World& world, const Camera& camera);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// `time` [s] sets the poses of things that move.
  RenderedFrame render(const Eigen::Isometry3d& T_world_camera, double time);

  /// The same with a shutter that is open for `exposure` [s] around `time`: colour is the mean of sharp images spread
  /// evenly over the exposure, each with its own poses of camera and things; one for every 1.5 px by which anything in
  /// the image moves meanwhile, at most 16. Depth, ids and cosine are those at `time`. With an exposure of 0, or where
  /// nothing moves that far, the sharp image. Takes as long as that many frames.
  RenderedFrame render(const std::function<Eigen::Isometry3d(double)>& T_world_camera, double time, double exposure);

 private:
  struct Parts;
  /// The longest way that anything in the frame goes in the image during the exposure [px].
  double image_motion(const RenderedFrame& frame, const std::function<Eigen::Isometry3d(double)>& T_world_camera,
                      double time, double exposure);

  std::unique_ptr<Parts> parts_;
};

}  // namespace holdfast::simulation
