// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/surface_field.hpp"

#include <algorithm>
#include <cmath>

#include "blocks.hpp"
#include "holdfast/dense_map/kept_view.hpp"
#include "marching_cubes.hpp"
#include "remnants.hpp"
#include "view_image.hpp"

namespace holdfast {

namespace {

using surface::Block;
using surface::Blocks;
using surface::ViewImage;

constexpr float growth = 1.5F;  // of the weight of a view in the balance, from view to view
constexpr std::uint32_t largest_number = 65535;
constexpr float nearest_depth = 0.1F;  // [m]

/// growth^-views
float faded(std::uint32_t views) {
  static const auto table = [] {
    std::array<float, 128> values{};
    float value = 1.0F;
    for (float& entry : values) entry = std::exchange(value, value / growth);
    return values;
  }();
  return views < table.size() ? table[views] : 0.0F;
}

/// Adds a view to the voxels of blocks (sign 1), or subtracts it (sign -1).
class Integrator {
 public:
  Integrator(const ViewImage& image, const Eigen::Isometry3d& T_world_camera, std::uint32_t number, int sign,
             const SurfaceSettings& settings)
      : image_(image),
        number_(std::min(number, largest_number)),
        sign_(sign),
        voxel_(static_cast<float>(settings.voxel)),
        truncation_(static_cast<float>(settings.truncation * settings.voxel)) {
    const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
    rotation_ = T_camera_world.linear().cast<float>();
    translation_ = T_camera_world.translation().cast<float>();
    const Camera& camera = image.camera();
    fx_ = static_cast<float>(camera.fx), fy_ = static_cast<float>(camera.fy);
    cx_ = static_cast<float>(camera.cx + 0.5), cy_ = static_cast<float>(camera.cy + 0.5);
  }

  void update(Block& block) const {
    const Eigen::Vector3f corner =
        rotation_ * (block.coordinates.cast<float>() * (voxel_ * Block::side)) + translation_;
    const Reach reach = reach_of(corner);
    if (reach == Reach::nothing) return;
    if (reach == Reach::all_free) {
      for (std::size_t i = 0; i < Block::size; ++i) add_balance(block, i, -1.0F);
      return;
    }
    const Eigen::Vector3f step_x = rotation_.col(0) * voxel_, step_y = rotation_.col(1) * voxel_;
    const Eigen::Vector3f step_z = rotation_.col(2) * voxel_;
    int i = 0;
    for (int x = 0; x < Block::side; ++x)
      for (int y = 0; y < Block::side; ++y) {
        const Eigen::Vector3f row = corner + static_cast<float>(x) * step_x + static_cast<float>(y) * step_y;
        for (int z = 0; z < Block::side; ++z, ++i) {
          const auto steps = static_cast<float>(z);
          const float depth = row.z() + steps * step_z.z();
          if (depth < nearest_depth) continue;
          const float inverse = 1.0F / depth;
          const float u = fx_ * (row.x() + steps * step_z.x()) * inverse + cx_;
          const float v = fy_ * (row.y() + steps * step_z.y()) * inverse + cy_;
          if (!(u >= 0.0F && v >= 0.0F && u < width() && v < height())) continue;
          update(block, static_cast<std::size_t>(i), image_.at(static_cast<int>(u), static_cast<int>(v)), depth);
        }
      }
  }

 private:
  float width() const { return static_cast<float>(image_.camera().width); }
  float height() const { return static_cast<float>(image_.camera().height); }

  /// Distance by which a surface must lie behind a voxel for it to be free [m].
  float margin_at(float depth) const { return std::max(truncation_, 0.04F + 0.01F * depth * depth); }

  /// What a view has to say about the voxels of a block.
  enum class Reach { nothing, something, all_free };

  /// Nothing of blocks outside the image, and of those behind all that is measured there.
  Reach reach_of(const Eigen::Vector3f& corner) const {
    const float half = 0.5F * voxel_ * Block::side;
    const Eigen::Vector3f centre = corner + rotation_ * Eigen::Vector3f::Constant(half);
    const float radius = half * 1.7321F;
    const float nearest = centre.z() - radius;
    if (centre.z() + radius < nearest_depth) return Reach::nothing;
    // Close to the camera the projection of the sphere may be unbounded.
    if (nearest < nearest_depth) return Reach::something;
    const float u = fx_ * centre.x() / centre.z() + cx_, v = fy_ * centre.y() / centre.z() + cy_;
    const float reach = 1.5F * std::max(fx_, fy_) * radius / nearest + 1.0F;
    if (u + reach < 0.0F || v + reach < 0.0F || u - reach > width() || v - reach > height()) return Reach::nothing;
    const int right = static_cast<int>(u + reach), bottom = static_cast<int>(v + reach);
    const float farthest = image_.farthest(static_cast<int>(std::max(u - reach, 0.0F)),
                                           static_cast<int>(std::max(v - reach, 0.0F)), right, bottom);
    if (farthest <= 0.0F || nearest >= farthest + truncation_ / ViewImage::smallest_slope) return Reach::nothing;
    if (!image_.only_carves()) return Reach::something;
    const float last = centre.z() + radius;
    if (nearest > farthest + margin_at(last)) return Reach::nothing;
    const int left = static_cast<int>(std::floor(u - reach)), top = static_cast<int>(std::floor(v - reach));
    return image_.nearest(left, top, right, bottom) - last > margin_at(last) ? Reach::all_free : Reach::something;
  }

  void update(Block& block, std::size_t i, const ViewImage::Pixel& pixel, float depth) const {
    const float margin = margin_at(depth);
    if (image_.only_carves()) {
      if (pixel.near <= 0.0F || depth - pixel.near > margin) return;
      add_balance(block, i, pixel.near - depth > margin ? -1.0F : 1.0F);
      return;
    }
    if ((pixel.near - depth) * pixel.slope > margin) {
      add_balance(block, i, -1.0F);
      return;
    }
    if (pixel.weight == 0) return;
    const float distance = (pixel.depth - depth) * pixel.slope;
    if (std::abs(distance) > truncation_) return;
    const auto units = static_cast<int>(std::lround(distance / truncation_ * Block::truncation_units));
    block.distance[i] += sign_ * units * pixel.weight;
    // Halves the sums before they overflow, after more than a thousand views.
    if (block.weight[i] > 65535 - 64) block.weight[i] /= 2, block.distance[i] /= 2;
    block.weight[i] = static_cast<std::uint16_t>(std::max(block.weight[i] + sign_ * pixel.weight, 0));
    if (block.views[i] < 255) block.views[i] = static_cast<std::uint8_t>(std::max(block.views[i] + sign_, 0));
    if (distance < 0.5F * truncation_) add_balance(block, i, 1.0F);
    if (std::abs(distance) < 1.5F * voxel_) add_colour(block, i, pixel);
  }

  void add_balance(Block& block, std::size_t i, float amount) const {
    const std::uint32_t last = block.last[i];
    if (number_ > last) {
      block.balance[i] *= faded(number_ - last);
      block.last[i] = static_cast<std::uint16_t>(number_);
    } else {
      amount *= faded(last - number_);
    }
    block.balance[i] += static_cast<float>(sign_) * amount;
  }

  void add_colour(Block& block, std::size_t i, const ViewImage::Pixel& pixel) const {
    if (!block.colour) block.colour = std::make_unique<std::array<Block::Colour, Block::size>>();
    Block::Colour& colour = (*block.colour)[i];
    if (sign_ > 0 && colour.count == Block::colour_limit) {
      colour.red /= 2, colour.green /= 2, colour.blue /= 2, colour.count /= 2;
    }
    const auto add = [&](std::uint16_t& sum, int value) {
      sum = static_cast<std::uint16_t>(std::max(sum + sign_ * value, 0));
    };
    add(colour.red, pixel.red);
    add(colour.green, pixel.green);
    add(colour.blue, pixel.blue);
    add(colour.count, 1);
  }

  const ViewImage& image_;
  std::uint32_t number_;
  int sign_;
  float voxel_, truncation_;
  Eigen::Matrix3f rotation_;
  Eigen::Vector3f translation_;
  float fx_, fy_, cx_, cy_;
};

/// Creates the blocks around the surface in a view, as far as marching cubes needs them.
void create_blocks(const ViewImage& image, const Eigen::Isometry3d& T_world_camera, double voxel, Blocks& blocks) {
  constexpr int stride = 2;                                    // [px]
  constexpr double reach = 2.0, most_reach = 5.0, step = 3.0;  // [voxels]
  const double scale = 1.0 / (voxel * Block::side);
  const Camera& camera = image.camera();
  Eigen::Vector3i last = Eigen::Vector3i::Constant(std::numeric_limits<int>::max());
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
        const Eigen::Vector3i block = (point * scale).array().floor().cast<int>();
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
    const Integrator integrator(image, fusion.T_world_camera, fusion.number, sign, settings);
    for (const auto& block : blocks.list())
      if (block->birth < fusion.blocks) integrator.update(*block);
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
  const ViewImage image(view, parts_->camera, parts_->settings);
  create_blocks(image, T_world_camera, parts_->settings.voxel, parts_->blocks);
  const Fusion fusion{T_world_camera, number, parts_->blocks.births()};
  parts_->integrate(image, fusion, 1);
  return fusion;
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

std::size_t SurfaceField::block_count() const { return parts_->blocks.list().size(); }

std::size_t SurfaceField::memory_bytes() const {
  std::size_t bytes = 0;
  for (const auto& block : parts_->blocks.list()) bytes += sizeof(Block) + (block->colour ? sizeof(*block->colour) : 0);
  return bytes;
}

const SurfaceSettings& SurfaceField::settings() const { return parts_->settings; }

}  // namespace holdfast
