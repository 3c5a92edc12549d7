// SPDX-License-Identifier: BSD-3-Clause
#include "regions.hpp"

#include <algorithm>

namespace holdfast::motion_objects_plugin {

void Regions::begin(const std::vector<BlockHint>& hints) {
  front_.clear();
  for (std::size_t i = 0; i < hints.size(); ++i)
    if (hints[i].track != BlockHint::background && hints[i].track != BlockHint::unknown)
      front_.push_back(static_cast<int>(i));
}

void Regions::connect(const BlockGrid& grid, const std::vector<float>& depth, const std::vector<BlockHint>& hints) {
  regions_.clear();
  blocks_.clear();
  region_of_.assign(hints.size(), -1);
  for (std::size_t i = 0; i < hints.size(); ++i) {
    if (hints[i].track == BlockHint::background || region_of_[i] >= 0) continue;
    const int number = static_cast<int>(regions_.size());
    Region region;
    region.track = hints[i].track;
    region.first = static_cast<int>(blocks_.size());
    region_of_[i] = number;
    blocks_.push_back(static_cast<int>(i));
    for (std::size_t next = static_cast<std::size_t>(region.first); next < blocks_.size(); ++next) {
      const int block = blocks_[next];
      for_each_beside(grid, depth, block, [&](int other) {
        const std::size_t o = static_cast<std::size_t>(other);
        const BlockHint& here = hints[static_cast<std::size_t>(block)];
        if (region_of_[o] >= 0 || hints[o].track != region.track) return;
        if (region.track == BlockHint::unknown && !agree(here, hints[o])) return;
        region_of_[o] = number;
        blocks_.push_back(other);
      });
    }
    region.size = static_cast<int>(blocks_.size()) - region.first;
    regions_.push_back(region);
  }
  for (Region& region : regions_) measure(grid, depth, region);
}

void Regions::measure(const BlockGrid& grid, const std::vector<float>& depth, Region& region) const {
  const int number = region_of_[static_cast<std::size_t>(blocks_[static_cast<std::size_t>(region.first)])];
  const float block_surface = 1.0F / (grid.fx * grid.inverse_step * grid.fy * grid.inverse_step);
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  Eigen::Vector2f ends(0, 0), cut(0, 0);
  for (const int block : blocks(region)) {
    const int column = block % grid.columns, row = block / grid.columns;
    const float z = depth[static_cast<std::size_t>(block)];
    const Eigen::Vector3f point(z * grid.ray_x[static_cast<std::size_t>(column)],
                                z * grid.ray_y[static_cast<std::size_t>(row)], z);
    region.box.extend(point);
    sum += point;
    region.surface += z * z * block_surface;
    int beside = 0;
    const auto look = [&](int axis, bool inside, int other) {
      if (inside && region_of_[static_cast<std::size_t>(other)] == number) {
        ++beside;
        return;
      }
      ends[axis] += 1.0F;
      const float there = inside ? depth[static_cast<std::size_t>(other)] : 0.0F;
      if (!inside || (there > 0.0F && there < z - depth_noise::continues_region(z))) cut[axis] += 1.0F;
    };
    look(0, column > 0, block - 1);
    look(0, column + 1 < grid.columns, block + 1);
    look(1, row > 0, block - grid.columns);
    look(1, row + 1 < grid.rows, block + grid.columns);
    region.inner += beside == 4 ? 1 : 0;
  }
  region.centroid = sum / static_cast<float>(region.size);
  region.cut = cut.cwiseQuotient(ends.cwiseMax(1.0F));
}

}  // namespace holdfast::motion_objects_plugin
