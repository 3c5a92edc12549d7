// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/depth_noise.hpp"
#include "holdfast/depth_blocks/depth_view.hpp"

namespace holdfast::motion_objects_plugin {

using depth_blocks::BlockGrid;

/// Prior knowledge of a block before the frame is divided into regions.
struct BlockHint {
  static constexpr std::uint32_t background = 0xFFFFFFFF;  ///< not a motion hypothesis
  static constexpr std::uint32_t unknown = 0;              ///< a motion hypothesis without a track

  std::uint32_t track = background;        ///< background, unknown, or the track that was here before
  std::uint8_t label = CellMask::unknown;  ///< of the mask
  std::uint16_t instance = 0;              ///< of the mask, 0 = none
};

/// A region of the frame that is connected in depth.
struct Region {
  std::uint32_t track = BlockHint::unknown;
  int first = 0, size = 0;       ///< of its blocks in Regions::blocks()
  Eigen::AlignedBox3f box;       ///< camera frame [m]
  Eigen::Vector3f centroid;      ///< mean of its points, camera frame [m]
  float surface = 0.0F;          ///< facing the camera [m^2]
  Eigen::Vector2f cut = {0, 0};  ///< fraction of its left and right ends, and of its upper and lower ends, that are cut
                                 ///< by the image border or a nearer surface
  int inner = 0;                 ///< number of blocks whose four neighbours belong to the region
};

/// Divides the motion hypotheses of a frame into regions that are connected in depth and belong to one track
/// (Co-Fusion, Ruenz and Agapito 2017, section IV-A: connected moving components become models). Reuses its buffers.
class Regions {
 public:
  /// Unknown blocks first join an adjacent track, in up to `growth` steps and if `may_join(block, track)`; the first
  /// step ignores the labels of the mask, because its outline is inexact. Regions are then the connected blocks of one
  /// track, or of no track and one mask label and instance. Regions are ordered by their first block.
  template <class MayJoin>
  void divide(const BlockGrid& grid, const std::vector<float>& depth, std::vector<BlockHint>& hints, int growth,
              const MayJoin& may_join) {
    begin(hints);
    for (int step = 0; step < growth && !front_.empty(); ++step) {
      next_front_.clear();
      for (const int block : front_)
        for_each_beside(grid, depth, block, [&](int other) {
          BlockHint& hint = hints[static_cast<std::size_t>(other)];
          const BlockHint& here = hints[static_cast<std::size_t>(block)];
          if (hint.track != BlockHint::unknown || are_apart(here, hint) || (step > 0 && !agree(here, hint))) return;
          if (!may_join(other, here.track)) return;
          hint.track = here.track;
          next_front_.push_back(other);
        });
      front_.swap(next_front_);
    }
    connect(grid, depth, hints);
  }

  const std::vector<Region>& regions() const { return regions_; }
  std::span<const int> blocks(const Region& region) const {
    return {blocks_.data() + region.first, static_cast<std::size_t>(region.size)};
  }

 private:
  static bool agree(const BlockHint& a, const BlockHint& b) {
    return !are_apart(a, b) && (a.label == b.label || a.label == CellMask::unknown || b.label == CellMask::unknown);
  }
  static bool are_apart(const BlockHint& a, const BlockHint& b) {
    return a.instance != 0 && b.instance != 0 && a.instance != b.instance;
  }
  template <class Visit>
  static void for_each_beside(const BlockGrid& grid, const std::vector<float>& depth, int block, const Visit& visit) {
    const int column = block % grid.columns, row = block / grid.columns;
    const float here = depth[static_cast<std::size_t>(block)];
    const auto offer = [&](int other) {
      if (std::abs(depth[static_cast<std::size_t>(other)] - here) < depth_noise::continues_region(here)) visit(other);
    };
    if (column > 0) offer(block - 1);
    if (column + 1 < grid.columns) offer(block + 1);
    if (row > 0) offer(block - grid.columns);
    if (row + 1 < grid.rows) offer(block + grid.columns);
  }
  void begin(const std::vector<BlockHint>& hints);
  void connect(const BlockGrid& grid, const std::vector<float>& depth, const std::vector<BlockHint>& hints);
  void measure(const BlockGrid& grid, const std::vector<float>& depth, Region& region) const;

  std::vector<Region> regions_;
  std::vector<int> blocks_;
  std::vector<int> front_, next_front_;
  std::vector<int> region_of_;  // of each block, -1 = none
};

}  // namespace holdfast::motion_objects_plugin
