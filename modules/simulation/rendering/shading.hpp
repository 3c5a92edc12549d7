// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/simulation/renderer.hpp"
#include "visibility.hpp"

namespace holdfast::simulation {

/// The grid of rays that covers the view of a camera: twice as many as pixels each way, in the undistorted image plane.
RayGrid ray_grid(const Camera& camera);

/// Contact shadows and where the camera stands among them.
struct FloorShade {
  std::vector<ContactShadow> shadows;
  Eigen::Matrix<float, 2, 4> xy_of_ray;  ///< upper rows of T_world_camera
};

/// Turns what each ray meets into the raw images of a camera.
class Shader {
 public:
  Shader(const Camera& camera, const RayGrid& grid);

  /// Fills all images of the frame with what `visibility` found from T_world_camera.
  void shade(const VisibilityBuffer& visibility, const std::vector<ContactShadow>& shadows,
             const Eigen::Isometry3d& T_world_camera, RenderedFrame& frame);
  /// The colour image alone, 8UC3.
  void shade_colour(const VisibilityBuffer& visibility, const std::vector<ContactShadow>& shadows,
                    const Eigen::Isometry3d& T_world_camera, cv::Mat& colour);

 private:
  /// What shades the floor in the view from T_world_camera.
  void take_shadows(const std::vector<ContactShadow>& shadows, const Eigen::Isometry3d& T_world_camera);
  void shade_row(const VisibilityBuffer& visibility, int y);
  void smooth_edges(const VisibilityBuffer& visibility, int y, std::uint8_t* colour) const;
  void blend_edge(const VisibilityBuffer& visibility, std::int32_t sample, const std::uint32_t* around,
                  float* colour) const;

  Camera camera_;
  // Of each pixel, row by row, each row with room for four more: the ray (x, y, 1), 1 / |(x, y, 1)|, and the nearest
  // sample of the grid (column + row * columns).
  int stride_ = 0;
  std::vector<float> ray_x_, ray_y_, inverse_length_;
  std::vector<std::int32_t> sample_;
  FloorShade floor_;
  // Of the row at hand.
  std::vector<std::uint32_t> numbers_;
  std::vector<float> depth_, cosine_, colours_;  // four colour values for each pixel
};

}  // namespace holdfast::simulation
