// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/surface_field.hpp"

#include <algorithm>
#include <cmath>

#include "blocks.hpp"
#include "holdfast/dense_map/kept_view.hpp"
#include "integrator.hpp"
#include "marching_cubes.hpp"
#include "patches.hpp"
#include "remnants.hpp"
#include "sampling.hpp"
#include "view_image.hpp"

namespace holdfast {

namespace {

using surface::Block;
using surface::Blocks;
using surface::Integrator;
using surface::ViewImage;

/// std::floor, which is a call of a function on processors without SSE4.
int floor_of(double value) {
  const int whole = static_cast<int>(value);
  return whole - static_cast<int>(static_cast<double>(whole) > value);
}

/// Creates the blocks around the surface in a view, as far as marching cubes needs them.
void create_blocks(const ViewImage& image, const Eigen::Isometry3d& T_world_camera, double voxel, Blocks& blocks) {
  constexpr int stride = 2;                                    // [px]
  constexpr double reach = 2.0, most_reach = 5.0, step = 3.0;  // [voxels]
  const double scale = 1.0 / (voxel * Block::side);
  const Camera& camera = image.camera();
  // Blocks that were met last, by a hash: few are looked up in the tree.
  std::vector<Eigen::Vector3i> recent(256, Eigen::Vector3i::Constant(std::numeric_limits<int>::max()));
  for (int y = 0; y < camera.height; y += stride)
    for (int x = 0; x < camera.width; x += stride) {
      const ViewImage::Pixel& pixel = image.at(x, y);
      if (pixel.weight == 0) continue;
      const Eigen::Vector3d ray = T_world_camera.linear() * camera.back_project(x, y, 1.0);
      const double half = std::min(reach / static_cast<double>(pixel.slope), most_reach) * voxel;
      const int steps = std::max(static_cast<int>(std::ceil(2.0 * half / (step * voxel))), 1);
      for (int i = 0; i <= steps; ++i) {
        const double depth = static_cast<double>(pixel.depth) - half + 2.0 * half * i / steps;
        const Eigen::Vector3d point = T_world_camera.translation() + depth * ray;
        const Eigen::Vector3i block(floor_of(point.x() * scale), floor_of(point.y() * scale),
                                    floor_of(point.z() * scale));
        const auto hash = static_cast<std::uint32_t>(block.x() + 5 * block.y() + 31 * block.z());
        Eigen::Vector3i& last = recent[hash % recent.size()];
        if (block == last) continue;
        blocks.at(block);
        last = block;
      }
    }
}

}  // namespace

struct SurfaceField::Parts {
  Camera camera;
  SurfaceSettings settings;
  Blocks blocks;

  void integrate(const ViewImage& image, const Fusion& fusion, int sign) {
    blocks.begin_change();
    Integrator(image, fusion.T_world_camera, fusion.number, sign, settings).update(blocks, fusion.blocks);
  }
  Fusion put_in(const ViewImage& image, const Eigen::Isometry3d& T_world_camera, std::uint32_t number) {
    if (!image.only_carves()) create_blocks(image, T_world_camera, settings.voxel, blocks);
    const Fusion fusion{T_world_camera, number, blocks.births()};
    integrate(image, fusion, 1);
    return fusion;
  }
};

bool SurfaceField::is_available() { return surface::BlockTree::is_available(); }

SurfaceField::SurfaceField(const Camera& camera, const SurfaceSettings& settings) : parts_(std::make_unique<Parts>()) {
  parts_->camera = camera;
  parts_->settings = settings;
}
SurfaceField::~SurfaceField() = default;
SurfaceField::SurfaceField(SurfaceField&&) noexcept = default;
SurfaceField& SurfaceField::operator=(SurfaceField&&) noexcept = default;

SurfaceField::Fusion SurfaceField::put_in(const KeptView& view, const Eigen::Isometry3d& T_world_camera,
                                          std::uint32_t number) {
  return parts_->put_in(ViewImage(view, parts_->camera, parts_->settings), T_world_camera, number);
}

SurfaceField::Fusion SurfaceField::move(const KeptView& view, const Fusion& fusion,
                                        const Eigen::Isometry3d& T_world_camera) {
  const ViewImage image(view, parts_->camera, parts_->settings);
  parts_->integrate(image, fusion, -1);
  return parts_->put_in(image, T_world_camera, fusion.number);
}

void SurfaceField::take_out(const KeptView& view, const Fusion& fusion) {
  parts_->integrate(ViewImage(view, parts_->camera, parts_->settings), fusion, -1);
}

void SurfaceField::remove_empty_blocks() {
  parts_->blocks.remove_if([](const Block& block) {
    return std::all_of(block.weight.begin(), block.weight.end(), [](std::uint16_t weight) { return weight == 0; });
  });
}

TriangleMesh SurfaceField::mesh() const {
  const SurfaceSettings& settings = parts_->settings;
  TriangleMesh mesh = surface::march(parts_->blocks, settings.voxel, settings.minimum_views);
  surface::remove_remnants(mesh, parts_->blocks, settings);
  remove_small_parts(mesh, settings.smallest_part);
  compute_normals(mesh);
  return mesh;
}

std::uint64_t SurfaceField::version() const { return parts_->blocks.version(); }

std::vector<SurfacePatch> SurfaceField::changes(std::uint64_t since, int coarseness) const {
  return surface::changed_patches(parts_->blocks, parts_->settings, since, coarseness);
}

std::optional<SurfaceField::Sample> SurfaceField::sample(const Eigen::Vector3f& point) const {
  return surface::sample(parts_->blocks, parts_->settings, point / static_cast<float>(parts_->settings.voxel));
}

std::size_t SurfaceField::count_unobserved(const std::vector<Eigen::Vector3f>& points, int views) const {
  std::size_t unobserved = 0;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3i voxel = (point / static_cast<float>(parts_->settings.voxel)).array().round().cast<int>();
    const std::int32_t found = parts_->blocks.find({voxel.x() >> 3, voxel.y() >> 3, voxel.z() >> 3});
    const auto at = static_cast<std::size_t>(Block::index(voxel.x() & 7, voxel.y() & 7, voxel.z() & 7));
    if (found < 0 || !parts_->blocks.list()[static_cast<std::size_t>(found)]->is_observed(at, views)) ++unobserved;
  }
  return unobserved;
}

std::size_t SurfaceField::block_count() const { return parts_->blocks.list().size(); }

std::size_t SurfaceField::memory_bytes() const {
  std::size_t bytes = 0;
  for (const auto& block : parts_->blocks.list()) {
    bytes += sizeof(Block) + (block->colour ? sizeof(*block->colour) : 0);
    bytes += block->votes ? sizeof(*block->votes) : 0;
  }
  return bytes;
}

const SurfaceSettings& SurfaceField::settings() const { return parts_->settings; }

}  // namespace holdfast
