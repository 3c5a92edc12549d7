// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/surface_patch.hpp"
#include "holdfast/surface/surface_settings.hpp"
#include "holdfast/surface/triangle_mesh.hpp"

namespace holdfast {

struct KeptView;

/// Truncated signed distance field of the static scene (Curless and Levoy, SIGGRAPH 1996) in sparse blocks of 8^3
/// voxels, whose tree is OpenVDB's (Museth, TOG 2013; Vizzo et al., VDBFusion, Sensors 2022).
///
/// Each view adds the distance of a voxel to the tangent plane of the surface in the voxel's pixel, positive in free
/// space, with the weight cos^2(viewing angle) / depth_noise::alignment_deviation(depth)^2. Dynamic pixels have no
/// weight, but votes: a surface that twice as many views called dynamic (amid dynamic pixels) as static is left out.
/// The sums are integers, so that a view can be taken out again exactly (Dai et al., BundleFusion, TOG 2017),
/// and the order of views has no influence on them.
///
/// Free space: besides, a voxel has a balance of views that observed a surface at it (+1) and of views that observed
/// free space beyond it (-1), in which a view counts 1.5 times as much as the view before it. A voxel below -1.2 is
/// free, whatever surface was observed there: surfaces that disappeared are removed after three views, and surfaces
/// that appeared are kept. A view sees through a voxel if all depths of the 3x3 pixels around it are larger by the
/// truncation and by 4 cm plus 1 % of the squared depth. The coarse depth of frames between keyframes (CarvingViews)
/// counts in the balance where it sees through. The mesh leaves out remnants: parts that adjoin removed surface
/// with half of their vertices, and at which no view has looked since.
///
/// Memory: 7.1 kB per block, and 4 kB of colour for each block that a surface crosses. Used by one thread.
class SurfaceField {
 public:
  /// Whether Holdfast was built with OpenVDB; without it the constructor throws Error.
  static bool is_available();

  /// `camera` is the pinhole camera of the views.
  SurfaceField(const Camera& camera, const SurfaceSettings& settings);
  ~SurfaceField();
  SurfaceField(SurfaceField&&) noexcept;
  SurfaceField& operator=(SurfaceField&&) noexcept;

  /// The fusion of a view, which take_out() needs.
  struct Fusion {
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    std::uint32_t number = 0;  ///< of the view in order of time; numbers above 65535 count as equal
    std::uint64_t blocks = 0;  ///< blocks that were created later have nothing of this view
  };

  /// Adds a view at a pose.
  Fusion put_in(const KeptView& view, const Eigen::Isometry3d& T_world_camera, std::uint32_t number);
  /// Subtracts what put_in() added.
  void take_out(const KeptView& view, const Fusion& fusion);
  /// take_out() and put_in() at another pose, with one preparation of the image.
  Fusion move(const KeptView& view, const Fusion& fusion, const Eigen::Isometry3d& T_world_camera);
  /// Removes blocks in which no view observes a surface.
  void remove_empty_blocks();

  /// The zero crossing of the field with normals and colours, by marching cubes (Lorensen and Cline, SIGGRAPH 1987)
  /// with separated negative corners on ambiguous faces: the mesh is closed except where the field ends. Vertices are
  /// shared, also between blocks. Parts smaller than SurfaceSettings::smallest_part are left out.
  TriangleMesh mesh() const;

  /// Grows with each view that is put in, moved or taken out.
  std::uint64_t version() const;
  /// Meshes of the cubes of 8^3 voxels in which the surface may have changed since an earlier version, by marching
  /// cubes over each alone, with the gradient of the field as normals; since 0: of all in which there is surface.
  /// Patches without triangles: the surface is gone. Nothing is left out of it as of mesh(). `coarseness` from 0 to 2:
  /// the field is sampled by the means of 1^3, 2^3 or 4^3 voxels.
  std::vector<SurfacePatch> changes(std::uint64_t since, int coarseness) const;

  /// The field at a point.
  struct Sample {
    float distance = 0.0F;                            ///< to the surface, positive before it [m]
    Eigen::Vector3f slope = Eigen::Vector3f::Zero();  ///< gradient of the distance [m per m]
  };
  /// Interpolates the field between voxels; empty where one of the eight around is not observed, or free. Not at the
  /// same time as changes() or a change, because it keeps the last place in the tree.
  std::optional<Sample> sample(const Eigen::Vector3f& point) const;

  /// Number of points at whose nearest voxel fewer than `views` views observed a surface. See sample().
  std::size_t count_unobserved(const std::vector<Eigen::Vector3f>& points, int views) const;

  std::size_t block_count() const;
  std::size_t memory_bytes() const;
  const SurfaceSettings& settings() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace holdfast
