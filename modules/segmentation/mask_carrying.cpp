// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/segmentation/mask_carrying.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace holdfast {

namespace {

constexpr std::uint8_t unknown = 255;
bool is_object(std::uint8_t label) { return label != 0 && label != unknown; }

/// Depths of a surface that stands still, seen from two places, differ by less [m].
float same_place(float depth) { return 0.01F + 0.012F * depth; }
/// Depths of a surface that moved differ by less, when its motion is known [m].
float same_surface(float depth) { return 0.015F + 0.02F * depth; }
/// What lies behind or before something else differs by more [m].
float apart(float depth) { return 0.02F + 0.03F * depth; }
/// Depths of neighbouring cells of one surface differ by less [m].
float continues_surface(float depth) { return 0.02F + 0.015F * depth; }

}  // namespace

void MaskCarrier::find_movers(const CoarseGrid& grid, const FollowedPairs& pairs) {
  block_columns_ = (grid.columns + block - 1) / block;
  block_rows_ = (grid.rows + block - 1) / block;
  const std::size_t blocks = static_cast<std::size_t>(block_columns_) * static_cast<std::size_t>(block_rows_);
  movers_.resize(blocks * most_movers);
  mover_count_.assign(blocks, 0);
  constexpr float reach = 3.0F * block * CoarseGrid::step;  // px
  for (int row = 0; row < block_rows_; ++row)
    for (int column = 0; column < block_columns_; ++column) {
      const float x = grid.left + (static_cast<float>(column) + 0.5F) * block * CoarseGrid::step;
      const float y = grid.top + (static_cast<float>(row) + 0.5F) * block * CoarseGrid::step;
      std::array<std::pair<float, std::size_t>, most_movers> nearest;
      std::size_t count = 0;
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        const float dx = pairs.to_x[i] - x, dy = pairs.to_y[i] - y;
        const float distance = dx * dx + dy * dy;
        if (distance > reach * reach || (count == most_movers && distance >= nearest[count - 1].first)) continue;
        std::size_t place = count < most_movers ? count++ : count - 1;
        for (; place > 0 && nearest[place - 1].first > distance; --place) nearest[place] = nearest[place - 1];
        nearest[place] = {distance, i};
      }
      const std::size_t index =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(block_columns_) + static_cast<std::size_t>(column);
      mover_count_[index] = static_cast<std::uint8_t>(count);
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t i = nearest[k].second;
        const auto cells = [](float pixels) { return static_cast<int>(std::lround(pixels / CoarseGrid::step)); };
        const bool deep = pairs.from_depth[i] > 0.0F && pairs.to_depth[i] > 0.0F;
        movers_[index * most_movers + k] = {cells(pairs.from_x[i] - pairs.to_x[i]),
                                            cells(pairs.from_y[i] - pairs.to_y[i]),
                                            deep ? pairs.from_depth[i] - pairs.to_depth[i] : 0.0F};
      }
    }
}

void MaskCarrier::carry(const CoarseView& from_view, const CellLabels& from, const CoarseView& to_view,
                        const Eigen::Isometry3d& T_to_from, const FollowedPairs& pairs, CellLabels& to) {
  const CoarseGrid& grid = to_view.grid;
  find_movers(grid, pairs);
  const std::size_t size = static_cast<std::size_t>(grid.size());
  to.labels.assign(size, 0);
  to.quality.assign(size, 255);
  to.moving.assign(size, 0);
  const auto take = [&](std::size_t cell, std::size_t source) {
    to.labels[cell] = from.labels[source];
    to.quality[cell] = from.quality[source];
    to.moving[cell] = from.moving[source];
  };
  past_.assign(size, Past::hidden);
  const Eigen::Isometry3d T_from_to = T_to_from.inverse();
  const Eigen::Matrix3f R = T_from_to.linear().cast<float>();
  const Eigen::Vector3f t = T_from_to.translation().cast<float>();
  const float fx = static_cast<float>(camera_.fx), fy = static_cast<float>(camera_.fy);
  const float cx = static_cast<float>(camera_.cx), cy = static_cast<float>(camera_.cy);

  for (int row = 0; row < grid.rows; ++row) {
    const float ray_y = (grid.y_of(row) - cy) / fy;
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t cell = static_cast<std::size_t>(row * grid.columns + column);
      const float depth = to_view.depth[cell];
      if (depth > 0.0F) {
        // Where the camera's motion alone says that this surface was.
        const float ray_x = (grid.x_of(column) - cx) / fx;
        const float z = depth * (R(2, 0) * ray_x + R(2, 1) * ray_y + R(2, 2)) + t.z();
        int source = -1;
        if (z > 0.05F)
          source = grid.cell_of(fx * (depth * (R(0, 0) * ray_x + R(0, 1) * ray_y + R(0, 2)) + t.x()) / z + cx,
                                fy * (depth * (R(1, 0) * ray_x + R(1, 1) * ray_y + R(1, 2)) + t.y()) / z + cy);
        const float before = source < 0 ? 0.0F : from_view.depth[static_cast<std::size_t>(source)];
        if (before == 0.0F) {
          past_[cell] = Past::unseen;
        } else if (std::abs(before - z) < apart(z)) {
          past_[cell] = Past::same;
          take(cell, static_cast<std::size_t>(source));
          // Almost the same place may still be an object that has just come there.
          if (to.labels[cell] != 0 || std::abs(before - z) < same_place(z)) continue;
        } else if (before > z + apart(z)) {
          past_[cell] = Past::free;
        }
      }
      // Where a part of an object nearby moved from.
      const std::size_t place = static_cast<std::size_t>((row / block) * block_columns_ + column / block);
      for (std::size_t k = 0; k < mover_count_[place]; ++k) {
        const Mover& mover = movers_[place * most_movers + k];
        const int source_column = column + mover.columns, source_row = row + mover.rows;
        if (source_column < 0 || source_row < 0 || source_column >= grid.columns || source_row >= grid.rows) continue;
        const std::size_t source = static_cast<std::size_t>(source_row * grid.columns + source_column);
        if (!is_object(from.labels[source])) continue;
        const float before = from_view.depth[source];
        if (depth > 0.0F && (before == 0.0F || std::abs(before - depth - mover.depth_change) > same_surface(depth)))
          continue;
        take(cell, source);
        break;
      }
      // What is too near to have depth, as people before the camera are, shows how the camera turned and no more. Not
      // at the border of an object: there, depth is missing for other reasons.
      if (depth > 0.0F || to.labels[cell] != 0) continue;
      const Eigen::Vector3f ray = R * Eigen::Vector3f((grid.x_of(column) - cx) / fx, ray_y, 1.0F);
      if (ray.z() < 0.05F) continue;
      const int c = grid.column_of(fx * ray.x() / ray.z() + cx), r = grid.row_of(fy * ray.y() / ray.z() + cy);
      constexpr int border = 3;  // cells
      const auto is_near_object = [&](int dc, int dr) {
        if (c < 0 || r < 0 || c >= grid.columns || r >= grid.rows) return false;
        const int there = std::clamp(r + dr, 0, grid.rows - 1) * grid.columns + std::clamp(c + dc, 0, grid.columns - 1);
        return is_object(from.labels[static_cast<std::size_t>(there)]);
      };
      if (is_near_object(0, 0) && from_view.depth[static_cast<std::size_t>(r * grid.columns + c)] == 0.0F &&
          is_near_object(-border, 0) && is_near_object(border, 0) && is_near_object(0, -border) &&
          is_near_object(0, border))
        take(cell, static_cast<std::size_t>(r * grid.columns + c));
    }
  }
  grow(to_view, to);
  fill_holes(to_view, to);
}

void MaskCarrier::grow(const CoarseView& to_view, CellLabels& to) {
  // What stands where there was free space has come with the object; what was not seen before may be anything, so the
  // object takes only a little of it; what was hidden before is what the object uncovered.
  const CoarseGrid& grid = to_view.grid;
  constexpr int most_unseen_steps = 15, most_steps = 60;
  constexpr float most_depth_change = 0.1F;  // m, over what was not seen before
  constexpr std::array<std::pair<int, int>, 4> neighbours{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  front_.clear();
  start_depth_.resize(to.labels.size());
  for (std::int32_t cell = 0; cell < grid.size(); ++cell)
    if (is_object(to.labels[static_cast<std::size_t>(cell)])) {
      front_.push_back(cell);
      start_depth_[static_cast<std::size_t>(cell)] = to_view.depth[static_cast<std::size_t>(cell)];
    }
  for (int step = 0; step < most_steps && !front_.empty(); ++step) {
    next_front_.clear();
    for (const std::int32_t cell : front_) {
      const int column = cell % grid.columns, row = cell / grid.columns;
      const float depth = to_view.depth[static_cast<std::size_t>(cell)];
      if (depth == 0.0F) continue;
      for (const auto& [dc, dr] : neighbours) {
        const int c = column + dc, r = row + dr;
        if (c < 0 || r < 0 || c >= grid.columns || r >= grid.rows) continue;
        const std::size_t other = static_cast<std::size_t>(r * grid.columns + c);
        if (to.labels[other] != 0) continue;
        const float there = to_view.depth[other];
        if (there == 0.0F || std::abs(there - depth) > continues_surface(depth)) continue;
        const float start = start_depth_[static_cast<std::size_t>(cell)];
        const bool may_be_object =
            past_[other] == Past::free ||
            (past_[other] == Past::unseen && step < most_unseen_steps && std::abs(there - start) < most_depth_change);
        if (!may_be_object) continue;
        start_depth_[other] = start;
        to.moving[other] = to.moving[static_cast<std::size_t>(cell)];
        to.labels[other] = to.labels[static_cast<std::size_t>(cell)];
        to.quality[other] = static_cast<std::uint8_t>(to.quality[static_cast<std::size_t>(cell)] * 15 / 16);
        next_front_.push_back(static_cast<std::int32_t>(other));
      }
    }
    front_.swap(next_front_);
  }
}

void MaskCarrier::fill_holes(const CoarseView& to_view, CellLabels& to) {
  // Cells without depth amid an object belong to it.
  const CoarseGrid& grid = to_view.grid;
  for (int row = 1; row + 1 < grid.rows; ++row)
    for (int column = 1; column + 1 < grid.columns; ++column) {
      const std::size_t cell = static_cast<std::size_t>(row * grid.columns + column);
      if (to.labels[cell] != 0 || to_view.depth[cell] > 0.0F) continue;
      const auto width = static_cast<std::ptrdiff_t>(grid.columns);
      int labelled = 0;
      std::uint8_t label = 0, quality = 255;
      for (const std::ptrdiff_t offset : {-width, width, std::ptrdiff_t{-1}, std::ptrdiff_t{1}}) {
        const std::size_t other = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(cell) + offset);
        if (!is_object(to.labels[other])) continue;
        ++labelled;
        label = to.labels[other];
        quality = std::min(quality, to.quality[other]);
      }
      if (labelled >= 3) to.labels[cell] = label, to.quality[cell] = quality;
    }
}

}  // namespace holdfast
