// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <utility>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/surface/surface_settings.hpp"

namespace holdfast {
struct KeptView;
}

namespace holdfast::surface {

/// A view as the fusion reads it.
class ViewImage {
 public:
  static constexpr int tile = 8;  ///< [px]
  static constexpr float smallest_slope = 0.2F;

  struct Pixel {
    float depth = 0.0F;  ///< of the surface, negative if it is dynamic [m]
    float near = 0.0F;   ///< smallest depth, static or dynamic, of the 3x3 pixels around [m]; 0 if one is missing
    /// Distance to the tangent plane per difference in depth; at least smallest_slope.
    float slope = smallest_slope;
    std::uint8_t weight = 0;  ///< 1 to 64; 0 = nothing to fuse
    std::uint8_t red = 0, green = 0, blue = 0;
  };

  /// `camera` is that of the kept views of keyframes.
  ViewImage(const KeptView& view, const Camera& camera, const SurfaceSettings& settings);

  /// Whether the view has no surface to fuse: it has no pixels().
  bool only_carves() const { return only_carves_; }

  const Camera& camera() const { return camera_; }
  const Pixel& at(int x, int y) const { return pixels_[static_cast<std::size_t>(y * camera_.width + x)]; }
  const Pixel* pixels() const { return pixels_.data(); }
  /// Depths of a view that only carves, each the smallest of several pixels of the camera [m]; 0 if one is missing.
  const float* near() const { return near_.data(); }
  /// KeptView::labels side by side in memory; nullptr if there are none.
  const std::uint8_t* labels() const { return labels_.empty() ? nullptr : labels_.ptr<std::uint8_t>(); }
  /// Largest depth in a rectangle of pixels, or in slightly more than it [m].
  float farthest(int left, int top, int right, int bottom) const;
  /// Smallest and largest of near() in a rectangle of pixels; the smallest is 0 if one is missing or outside the image.
  std::pair<float, float> near_range(int left, int top, int right, int bottom) const;

 private:
  void read_carving_depth(const KeptView& view);
  /// Fills the pixels without slope and weight; returns all depths, those of dynamic pixels included.
  cv::Mat read_depth(const KeptView& view, float maximum_depth);
  void extend_tile(int x, int y, float depth) {
    float& farthest = tiles_[static_cast<std::size_t>(y / tile * tile_columns_ + x / tile)];
    farthest = std::max(farthest, depth);
  }

  Camera camera_;
  bool only_carves_;
  std::vector<Pixel> pixels_;
  std::vector<float> near_;
  cv::Mat labels_;                      // continuous
  std::vector<float> rays_x_, rays_y_;  // of the columns and rows, at depth 1
  std::vector<float> tiles_;            // largest depth of each tile [m]
  int tile_columns_ = 0;
};

}  // namespace holdfast::surface
