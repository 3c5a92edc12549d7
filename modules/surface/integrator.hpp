// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <utility>

#include "blocks.hpp"
#include "holdfast/surface/surface_settings.hpp"
#include "view_image.hpp"

namespace holdfast::surface {

/// What the update of a block needs of a view, as plain numbers.
struct ViewGeometry {
  float rotation[9] = {}, translation[3] = {};  ///< T_camera_world; the rotation by columns, times the side of a voxel
  float fx = 0.0F, fy = 0.0F, cx = 0.0F, cy = 0.0F, width = 0.0F, height = 0.0F;
  const ViewImage::Pixel* pixels = nullptr;  ///< of a view that does not only carve
  const float* near = nullptr;               ///< of a view that only carves: see ViewImage::near()
  const std::uint8_t* labels = nullptr;      ///< of the pixels; nullptr without classes
  float voxel = 0.0F, truncation = 0.0F;     ///< [m]
  std::int32_t number = 0, sign = 1;         ///< see SurfaceField::Fusion; 1 = add the view, -1 = subtract it

  /// Distance by which a surface must lie behind a voxel for it to be free [m].
  static constexpr float constant_margin = 0.04F, quadratic_margin = 0.01F;
};

/// Adds a view to the voxels of blocks (sign 1), or subtracts it (sign -1): eight voxels at once, with the same result
/// at every SimdLevel.
class Integrator {
 public:
  Integrator(const ViewImage& image, const Eigen::Isometry3d& T_world_camera, std::uint32_t number, int sign,
             const SurfaceSettings& settings);

  /// Updates the blocks that were created before Fusion::blocks reached `births`.
  void update(const Blocks& blocks, std::uint64_t births) const;

 private:
  /// What a view has to say about the voxels of a block.
  enum class Reach { nothing, something, all_free };

  float margin_at(float depth) const;
  /// By the position of a block's corner in the camera. Nothing of blocks outside the image, and of those behind all
  /// that is measured there. Second: no depth is larger there, of a view that only carves [m].
  std::pair<Reach, float> reach_of(const Eigen::Vector3f& corner) const;

  const ViewImage& image_;
  ViewGeometry view_;
  Eigen::Matrix3f rotation_;
  Eigen::Vector3f translation_;
  Eigen::Vector3f centre_, half_;  // of a block in the camera's axes, relative to its corner; half the sides of its box
  void (*update_voxels_)(const ViewGeometry& view, const float* corner, float far, Block& block);
  void (*carve_all_)(const ViewGeometry& view, const float* corner, float far, Block& block);
};

}  // namespace holdfast::surface
