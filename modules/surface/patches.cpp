// SPDX-License-Identifier: BSD-3-Clause
#include "patches.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cube_cases.hpp"
#include "holdfast/core/check.hpp"

namespace holdfast::surface {

namespace {

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

/// Marching cubes over the cells of one block. A sample is the mean of scale^3 voxels; there is one more layer of
/// samples around the block for normals, and a second one where cells reach into the next block.
class PatchMarcher {
 public:
  PatchMarcher(const Blocks& blocks, const SurfaceSettings& settings, int coarseness)
      : blocks_(blocks),
        minimum_views_(settings.minimum_views),
        voxel_(static_cast<float>(settings.voxel)),
        scale_(1 << coarseness),
        cells_(Block::side / scale_),
        side_(cells_ + 3),
        values_(static_cast<std::size_t>(side_ * side_ * side_)),
        vertices_(static_cast<std::size_t>(3 * (cells_ + 1) * (cells_ + 1) * (cells_ + 1))) {}

  SurfacePatch march(const Block& block) {
    patch_ = {block.coordinates, {}, {}};
    find_neighbours(block);
    if (!gather()) return std::move(patch_);
    std::fill(vertices_.begin(), vertices_.end(), none);
    colourless_.clear();
    for (int x = 0; x < cells_; ++x)
      for (int y = 0; y < cells_; ++y)
        for (int z = 0; z < cells_; ++z) add_triangles({x, y, z});
    colour_the_rest();
    return std::move(patch_);
  }

 private:
  static constexpr std::uint16_t none = 0xFFFF;

  void find_neighbours(const Block& block) {
    for (int i = 0; i < 27; ++i) {
      const Eigen::Vector3i offset(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1);
      const std::int32_t found = blocks_.find(block.coordinates + offset);
      around_[static_cast<std::size_t>(i)] =
          found < 0 ? nullptr : blocks_.list()[static_cast<std::size_t>(found)].get();
    }
  }

  /// The block of a voxel, which is counted from the corner of the middle block, and its index there.
  const Block* find(const Eigen::Vector3i& voxel, std::size_t& index) const {
    const Eigen::Vector3i block(voxel.x() >> 3, voxel.y() >> 3, voxel.z() >> 3);
    index = static_cast<std::size_t>(Block::index(voxel.x() & 7, voxel.y() & 7, voxel.z() & 7));
    return around_[static_cast<std::size_t>(9 * (block.x() + 1) + 3 * (block.y() + 1) + block.z() + 1)];
  }

  template <class Visit>
  void for_voxels_of(const Eigen::Vector3i& sample, const Visit& visit) const {
    for (int x = 0; x < scale_; ++x)
      for (int y = 0; y < scale_; ++y)
        for (int z = 0; z < scale_; ++z) {
          std::size_t index = 0;
          if (const Block* block = find(scale_ * sample + Eigen::Vector3i(x, y, z), index)) visit(*block, index);
        }
  }

  float& value(const Eigen::Vector3i& sample) {
    return values_[static_cast<std::size_t>(((sample.x() + 1) * side_ + sample.y() + 1) * side_ + sample.z() + 1)];
  }

  /// Reads the samples; false if no surface crosses the cells.
  bool gather() {
    bool has_negative = false, has_positive = false;
    for (int x = -1; x <= cells_ + 1; ++x)
      for (int y = -1; y <= cells_ + 1; ++y)
        for (int z = -1; z <= cells_ + 1; ++z) {
          float sum = 0.0F;
          int count = 0;
          for_voxels_of({x, y, z}, [&](const Block& block, std::size_t index) {
            const float one = block.value(static_cast<int>(index), minimum_views_);
            if (!std::isnan(one)) sum += one, ++count;
          });
          const float mean = value({x, y, z}) = count == 0 ? unknown : sum / static_cast<float>(count);
          has_negative = has_negative || mean < 0.0F;
          has_positive = has_positive || mean >= 0.0F;
        }
    return has_negative && has_positive;
  }

  void add_triangles(const Eigen::Vector3i& cell) {
    unsigned negative = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const float here = value(cell + offset_of(corner));
      if (std::isnan(here)) return;
      if (here < 0.0F) negative |= 1U << corner;
    }
    if (negative == 0 || negative == 255) return;
    for (const CubeCases::EdgeTriangle& edges : CubeCases::triangles(negative))
      patch_.triangles.push_back({vertex_on(cell, edges[0]), vertex_on(cell, edges[1]), vertex_on(cell, edges[2])});
  }

  static Eigen::Vector3i offset_of(int corner) {
    return {CubeCases::corner_offset(corner, 0), CubeCases::corner_offset(corner, 1),
            CubeCases::corner_offset(corner, 2)};
  }

  std::uint16_t vertex_on(const Eigen::Vector3i& cell, int edge) {
    const Eigen::Vector3i from = cell + offset_of(edge / 3);
    const int axis = edge % 3, layer = cells_ + 1;
    std::uint16_t& number =
        vertices_[static_cast<std::size_t>(3 * ((from.x() * layer + from.y()) * layer + from.z()) + axis)];
    if (number != none) return number;
    number = static_cast<std::uint16_t>(patch_.vertices.size());
    const Eigen::Vector3i to = from + Eigen::Vector3i::Unit(axis);
    const float a = value(from), b = value(to), along = std::clamp(a / (a - b), 0.01F, 0.99F);
    MeshVertex vertex;
    // A sample is at the middle of its voxels.
    vertex.position = (patch_.cube * Block::side + from * scale_).cast<float>() +
                      Eigen::Vector3f::Constant(0.5F * static_cast<float>(scale_ - 1));
    vertex.position[axis] += along * static_cast<float>(scale_);
    vertex.position *= voxel_;
    const Eigen::Vector3f normal = (1.0F - along) * gradient(from) + along * gradient(to);
    if (const float length = normal.norm(); length > 0.0F) vertex.normal = normal / length;
    const bool other_is_nearer = along > 0.5F;
    if (!set_colour(vertex, other_is_nearer ? to : from) && !set_colour(vertex, other_is_nearer ? from : to))
      colourless_.push_back(number);
    patch_.vertices.push_back(vertex);
    return number;
  }

  Eigen::Vector3f gradient(const Eigen::Vector3i& sample) {
    Eigen::Vector3f result = Eigen::Vector3f::Zero();
    const float here = value(sample);
    for (int axis = 0; axis < 3; ++axis) {
      const float before = value(sample - Eigen::Vector3i::Unit(axis)),
                  after = value(sample + Eigen::Vector3i::Unit(axis));
      if (!std::isnan(before) && !std::isnan(after))
        result[axis] = 0.5F * (after - before);
      else if (!std::isnan(after))
        result[axis] = after - here;
      else if (!std::isnan(before))
        result[axis] = here - before;
    }
    return result;
  }

  bool set_colour(MeshVertex& vertex, const Eigen::Vector3i& sample) const {
    int red = 0, green = 0, blue = 0, count = 0;
    Block::Votes votes;
    for_voxels_of(sample, [&](const Block& block, std::size_t index) {
      if (!block.colour) return;
      if (const std::uint8_t one = label_of(block, index); one != Block::Votes::unknown) votes.add(one, 1);
      const Block::Colour& colour = (*block.colour)[index];
      red += colour.red, green += colour.green, blue += colour.blue, count += colour.count;
    });
    if (count == 0) return false;
    const auto mean = [&](int sum) { return static_cast<std::uint8_t>((sum + count / 2) / count); };
    vertex.red = mean(red), vertex.green = mean(green), vertex.blue = mean(blue);
    vertex.label = votes.winner();
    return true;
  }

  /// Vertices at the rims of free space get the mean colour of the others, or grey without any.
  void colour_the_rest() {
    std::array<std::size_t, 3> sum{};
    std::size_t next = 0;
    for (std::size_t i = 0; i < patch_.vertices.size(); ++i) {
      if (next < colourless_.size() && colourless_[next] == i) {
        ++next;
        continue;
      }
      const MeshVertex& vertex = patch_.vertices[i];
      sum[0] += vertex.red, sum[1] += vertex.green, sum[2] += vertex.blue;
    }
    const std::size_t count = patch_.vertices.size() - colourless_.size();
    const auto mean = [&](int channel) {
      return count == 0 ? std::uint8_t{128} : static_cast<std::uint8_t>(sum[static_cast<std::size_t>(channel)] / count);
    };
    for (const std::uint16_t number : colourless_) {
      MeshVertex& vertex = patch_.vertices[number];
      vertex.red = mean(0), vertex.green = mean(1), vertex.blue = mean(2);
    }
  }

  const Blocks& blocks_;
  int minimum_views_;
  float voxel_;
  int scale_, cells_, side_;
  std::array<const Block*, 27> around_{};
  std::vector<float> values_;              // of the samples
  std::vector<std::uint16_t> vertices_;    // by 3 * sample + axis: number in patch_, or none
  std::vector<std::uint16_t> colourless_;  // increasing
  SurfacePatch patch_;
};

/// The blocks whose cells reach to a block: itself, and those before it along each axis.
template <class Visit>
void for_dependents(const Blocks& blocks, const Eigen::Vector3i& coordinates, const Visit& visit) {
  for (int i = 0; i < 8; ++i)
    if (const std::int32_t found = blocks.find(coordinates - Eigen::Vector3i(i >> 2, i >> 1 & 1, i & 1)); found >= 0)
      visit(static_cast<std::size_t>(found));
}

}  // namespace

std::vector<SurfacePatch> changed_patches(const Blocks& blocks, const SurfaceSettings& settings, std::uint64_t since,
                                          int coarseness) {
  HOLDFAST_CHECK(coarseness >= 0 && coarseness <= 2, "coarseness " << coarseness);
  std::vector<bool> has_changed(blocks.list().size(), since == 0);
  std::vector<SurfacePatch> patches;
  const auto mark = [&](std::size_t number) { has_changed[number] = true; };
  if (since > 0) {
    for (const auto& block : blocks.list())
      if (block->version > since) for_dependents(blocks, block->coordinates, mark);
    for (const Blocks::Removal& removal : blocks.removals()) {
      if (removal.version <= since) continue;
      for_dependents(blocks, removal.coordinates, mark);
      if (blocks.find(removal.coordinates) < 0) patches.push_back({removal.coordinates, {}, {}});
    }
  }
  PatchMarcher marcher(blocks, settings, coarseness);
  for (std::size_t i = 0; i < has_changed.size(); ++i) {
    if (!has_changed[i]) continue;
    SurfacePatch patch = marcher.march(*blocks.list()[i]);
    if (since > 0 || !patch.triangles.empty()) patches.push_back(std::move(patch));
  }
  return patches;
}

}  // namespace holdfast::surface
