// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/mask_transfer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "holdfast/core/coarse_cells.hpp"
#include "holdfast/core/depth_noise.hpp"
#include "holdfast/geometry/warp.hpp"

namespace holdfast {

namespace {

constexpr int reach = 3;  // radius in which a followed point gives the motion of its object [blocks]

/// Whether a neighbouring cell has no label.
bool is_outline(const std::vector<std::uint8_t>& labels, const CoarseGrid& grid, int column, int row) {
  const std::uint8_t* const label = &labels[static_cast<std::size_t>(row * grid.columns + column)];
  return (column > 0 && label[-1] == 0) || (column + 1 < grid.columns && label[1] == 0) ||
         (row > 0 && label[-grid.columns] == 0) || (row + 1 < grid.rows && label[grid.columns] == 0);
}

}  // namespace

void MaskTransfer::find_movers(const CoarseGrid& grid, const FollowedPairs& pairs) {
  block_columns_ = (grid.columns + block - 1) / block;
  block_rows_ = (grid.rows + block - 1) / block;
  const std::size_t blocks = static_cast<std::size_t>(block_columns_) * static_cast<std::size_t>(block_rows_);
  nearest_.resize(blocks * max_movers);
  mover_count_.assign(blocks, 0);
  for (std::size_t i = 0; i < pairs.size(); ++i) add_to_blocks(grid, pairs.to_x[i], pairs.to_y[i], i);

  movers_.resize(blocks * max_movers);
  const auto cells = [](float pixels) { return static_cast<int>(std::lround(pixels / CoarseGrid::step)); };
  for (std::size_t place = 0; place < blocks; ++place)
    for (std::size_t k = place * max_movers; k < place * max_movers + mover_count_[place]; ++k) {
      const std::size_t i = nearest_[k].pair;
      const bool deep = pairs.from_depth[i] > 0.0F && pairs.to_depth[i] > 0.0F;
      movers_[k] = {cells(pairs.from_x[i] - pairs.to_x[i]), cells(pairs.from_y[i] - pairs.to_y[i]),
                    deep ? pairs.from_depth[i] - pairs.to_depth[i] : 0.0F,
                    pairs.instance.empty() ? std::uint16_t{0} : pairs.instance[i]};
    }
}

void MaskTransfer::add_to_blocks(const CoarseGrid& grid, float x, float y, std::size_t pair) {
  constexpr float radius = static_cast<float>(reach * block * CoarseGrid::step);  // px
  const auto centre = [](float begin, int place) {
    return begin + (static_cast<float>(place) + 0.5F) * block * CoarseGrid::step;
  };
  const int last_row = std::min(block_rows_ - 1, grid.row_of(y + radius) / block);
  const int last_column = std::min(block_columns_ - 1, grid.column_of(x + radius) / block);
  for (int row = std::max(0, grid.row_of(y - radius) / block); row <= last_row; ++row)
    for (int column = std::max(0, grid.column_of(x - radius) / block); column <= last_column; ++column) {
      const float dx = x - centre(grid.left, column), dy = y - centre(grid.top, row);
      const float distance = dx * dx + dy * dy;
      if (distance > radius * radius) continue;
      const std::size_t index =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(block_columns_) + static_cast<std::size_t>(column);
      insert_by_distance({distance, pair}, &nearest_[index * max_movers], mover_count_[index]);
    }
}

void MaskTransfer::insert_by_distance(const Neighbour& added, Neighbour* nearest, std::uint8_t& count) {
  if (count == max_movers && added.distance >= nearest[count - 1].distance) return;
  std::size_t place = count < max_movers ? count++ : count - 1U;
  for (; place > 0 && nearest[place - 1].distance > added.distance; --place) nearest[place] = nearest[place - 1];
  nearest[place] = added;
}

/// One transfer: both views, both masks, and the ego-motion.
struct MaskTransfer::Job {
  const CoarseView& from_view;
  const CellMask& from;
  const CoarseView& to_view;
  CellMask& to;
  geometry::Warp warp;  // by T_from_to

  void take(std::size_t cell, std::size_t source) const {
    to.labels[cell] = from.labels[source];
    to.confidence[cell] = from.confidence[source];
    to.moving[cell] = from.moving[source];
    if (!from.instances.empty()) to.instances[cell] = from.instances[source];
  }
};

void MaskTransfer::transfer(const CoarseView& from_view, const CellMask& from, const CoarseView& to_view,
                            const Eigen::Isometry3d& T_to_from, const FollowedPairs& pairs, CellMask& to) {
  const CoarseGrid& grid = to_view.grid;
  find_movers(grid, pairs);
  const std::size_t size = static_cast<std::size_t>(grid.size());
  to.assign(size, CellMask::background, 255);
  if (!from.instances.empty()) to.instances.assign(size, 0);
  previous_state_.assign(size, CellState::occluded);
  constexpr float min_depth = 0.05F;  // m
  const Job job{.from_view = from_view,
                .from = from,
                .to_view = to_view,
                .to = to,
                .warp = geometry::Warp(T_to_from.inverse(), geometry::pinhole_of(camera_), min_depth)};
  if (!has_depth_) return transfer_by_points_alone(job, pairs);
  rays_x_.resize(grid.columns);
  for (int column = 0; column < grid.columns; ++column) rays_x_[column] = job.warp.ray_x(grid.x_of(column));
  for (int row = 0; row < grid.rows; ++row) {
    take_row_by_ego_motion(job, row);
    for (const int column : open_columns_) {
      take_by_object_motion(job, column, row);
      const std::size_t cell = static_cast<std::size_t>(row * grid.columns + column);
      if (to_view.depth[cell] > 0.0F || to.labels[cell] != 0) continue;
      take_without_depth(job, column, row);
    }
  }
  grow(to_view, to);
  fill_holes(to_view, to);
}

void MaskTransfer::transfer_by_points_alone(const Job& job, const FollowedPairs& pairs) {
  const CoarseGrid& grid = job.to_view.grid;
  // Blocks with followed points in the previous view: their labels moved with the points and do not remain.
  std::vector<std::uint8_t> is_followed(mover_count_.size(), 0);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const int column = grid.column_of(pairs.from_x[i]) / block, row = grid.row_of(pairs.from_y[i]) / block;
    for (int r = std::max(0, row - reach); r <= std::min(block_rows_ - 1, row + reach); ++r)
      for (int c = std::max(0, column - reach); c <= std::min(block_columns_ - 1, column + reach); ++c)
        is_followed[static_cast<std::size_t>(r * block_columns_ + c)] = 1;
  }
  // The nearest cell of the grid extrapolates labels beyond its border.
  const auto cell_at = [&](int column, int row) {
    return static_cast<std::size_t>(std::clamp(row, 0, grid.rows - 1) * grid.columns +
                                    std::clamp(column, 0, grid.columns - 1));
  };
  const auto clamped_cells = [](float pixels, int cells) {
    return static_cast<int>(std::floor(std::clamp(pixels / CoarseGrid::step, -1.0F, static_cast<float>(cells))));
  };
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t cell = static_cast<std::size_t>(row * grid.columns + column);
      const std::size_t place = static_cast<std::size_t>((row / block) * block_columns_ + column / block);
      const std::size_t movers = mover_count_[place];
      if (movers == 0) {
        const auto warped =
            job.warp.project_direction(job.warp.ray_x(grid.x_of(column)), job.warp.ray_y(grid.y_of(row)));
        if (!warped) continue;
        const int from_column = std::clamp(clamped_cells(warped->x - grid.left, grid.columns), 0, grid.columns - 1);
        const int from_row = std::clamp(clamped_cells(warped->y - grid.top, grid.rows), 0, grid.rows - 1);
        if (is_followed[static_cast<std::size_t>((from_row / block) * block_columns_ + from_column / block)] == 0)
          job.take(cell, cell_at(from_column, from_row));
        continue;
      }
      std::size_t votes = 0, source = 0;
      for (std::size_t k = 0; k < movers; ++k) {
        const Mover& mover = movers_[place * max_movers + k];
        const std::size_t there = cell_at(column + mover.columns, row + mover.rows);
        if (mover.moves(job.from, there) && votes++ == 0) source = there;
      }
      if (2 * votes >= movers) job.take(cell, source);
    }
}

void MaskTransfer::take_row_by_ego_motion(const Job& job, int row) {
  const CoarseGrid& grid = job.to_view.grid;
  const auto columns = static_cast<std::size_t>(grid.columns), begin = static_cast<std::size_t>(row) * columns;
  const float* depth = &job.to_view.depth[begin];
  job.warp.row(rays_x_, job.warp.ray_y(grid.y_of(row)), Eigen::Map<const Eigen::ArrayXf>(depth, grid.columns), warped_);
  sources_.resize(columns);
  find_cells(grid, {warped_.x.data(), columns}, {warped_.y.data(), columns}, sources_);
  open_columns_.clear();
  // Locals, because the compiler must assume that storing a byte changes anything that is reached by a reference.
  const float* const z = warped_.z.data();
  const float* const depth_before = job.from_view.depth.data();
  const std::int32_t* const sources = sources_.data();
  CellState* const state = &previous_state_[begin];
  const std::uint8_t* const labels = job.from.labels.data();
  for (std::size_t column = 0; column < columns; ++column) {
    bool is_open = true;
    if (depth[column] > 0.0F) {
      const bool has_source = job.warp.is_visible(z[column]) && sources[column] >= 0;
      const std::size_t source = has_source ? static_cast<std::size_t>(sources[column]) : 0;
      const float before = has_source ? depth_before[source] : 0.0F;
      const float change = std::abs(before - z[column]), limit = depth_noise::occlusion(z[column]);
      if (before == 0.0F) {
        state[column] = CellState::unobserved;
      } else if (change < limit) {
        state[column] = CellState::same_surface;
        job.take(begin + column, source);
        // At almost the same position, the surface may still be an object that has just arrived.
        is_open = labels[source] == 0 && !(change < depth_noise::same_place(z[column]));
      } else if (before > z[column] + limit) {
        state[column] = CellState::free_space;
      }
    }
    if (is_open) open_columns_.push_back(static_cast<int>(column));
  }
}

void MaskTransfer::take_by_object_motion(const Job& job, int column, int row) {
  const CoarseGrid& grid = job.to_view.grid;
  const std::size_t cell = static_cast<std::size_t>(row * grid.columns + column);
  const float depth = job.to_view.depth[cell];
  const std::size_t place = static_cast<std::size_t>((row / block) * block_columns_ + column / block);
  for (std::size_t k = 0; k < mover_count_[place]; ++k) {
    const Mover& mover = movers_[place * max_movers + k];
    const int source_column = column + mover.columns, source_row = row + mover.rows;
    if (source_column < 0 || source_row < 0 || source_column >= grid.columns || source_row >= grid.rows) continue;
    const std::size_t source = static_cast<std::size_t>(source_row * grid.columns + source_column);
    if (!mover.moves(job.from, source)) continue;
    const float before = job.from_view.depth[source];
    if (depth > 0.0F &&
        (before == 0.0F || std::abs(before - depth - mover.depth_change) > depth_noise::same_surface(depth)))
      continue;
    job.take(cell, source);
    return;
  }
}

void MaskTransfer::take_without_depth(const Job& job, int column, int row) {
  // A surface too near for the depth sensor, such as a person right in front of the camera, is transferred by the
  // camera's rotation only. Cells at the border of an object are left out: depth is missing there for other reasons.
  const CoarseGrid& grid = job.to_view.grid;
  const auto warped = job.warp.project_direction(job.warp.ray_x(grid.x_of(column)), job.warp.ray_y(grid.y_of(row)));
  if (!warped) return;
  const int c = grid.column_of(warped->x);
  const int r = grid.row_of(warped->y);
  constexpr int border = 3;  // cells
  const auto is_near_object = [&](int dc, int dr) {
    if (c < 0 || r < 0 || c >= grid.columns || r >= grid.rows) return false;
    const int there = std::clamp(r + dr, 0, grid.rows - 1) * grid.columns + std::clamp(c + dc, 0, grid.columns - 1);
    return CellMask::is_object(job.from.labels[static_cast<std::size_t>(there)]);
  };
  if (is_near_object(0, 0) && job.from_view.depth[static_cast<std::size_t>(r * grid.columns + c)] == 0.0F &&
      is_near_object(-border, 0) && is_near_object(border, 0) && is_near_object(0, -border) &&
      is_near_object(0, border))
    job.take(static_cast<std::size_t>(row * grid.columns + column), static_cast<std::size_t>(r * grid.columns + c));
}

void MaskTransfer::grow(const CoarseView& to_view, CellMask& to) {
  // Surface in former free space belongs to the object that arrived there. Over unobserved surface an object grows a
  // little only. Formerly occluded surface was uncovered by the object.
  const CoarseGrid& grid = to_view.grid;
  constexpr int max_unobserved_steps = 15, max_steps = 60;
  constexpr float max_depth_change = 0.1F;  // m, over unobserved surface
  constexpr std::array<std::pair<int, int>, 4> neighbours{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  front_.clear();
  start_depth_.resize(to.labels.size());
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t cell = static_cast<std::size_t>(row * grid.columns + column);
      if (!CellMask::is_object(to.labels[cell]) || !is_outline(to.labels, grid, column, row)) continue;
      front_.push_back(static_cast<std::int32_t>(cell));
      start_depth_[cell] = to_view.depth[cell];
    }
  for (int step = 0; step < max_steps && !front_.empty(); ++step) {
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
        if (there == 0.0F || std::abs(there - depth) > depth_noise::continues(depth)) continue;
        const float start = start_depth_[static_cast<std::size_t>(cell)];
        const bool may_be_object = previous_state_[other] == CellState::free_space ||
                                   (previous_state_[other] == CellState::unobserved && step < max_unobserved_steps &&
                                    std::abs(there - start) < max_depth_change);
        if (!may_be_object) continue;
        start_depth_[other] = start;
        to.moving[other] = to.moving[static_cast<std::size_t>(cell)];
        to.labels[other] = to.labels[static_cast<std::size_t>(cell)];
        if (!to.instances.empty()) to.instances[other] = to.instances[static_cast<std::size_t>(cell)];
        to.confidence[other] = static_cast<std::uint8_t>(to.confidence[static_cast<std::size_t>(cell)] * 15 / 16);
        next_front_.push_back(static_cast<std::int32_t>(other));
      }
    }
    front_.swap(next_front_);
  }
}

void MaskTransfer::fill_holes(const CoarseView& to_view, CellMask& to) {
  // Fill holes: cells without depth inside an object belong to it.
  const CoarseGrid& grid = to_view.grid;
  const std::size_t width = static_cast<std::size_t>(grid.columns);
  std::uint8_t* const labels = to.labels.data();
  const float* const depth = to_view.depth.data();
  for (std::size_t row = 1; row + 1 < static_cast<std::size_t>(grid.rows); ++row)
    for (std::size_t cell = row * width + 1; cell + 1 < (row + 1) * width; ++cell) {
      if (labels[cell] != 0 || depth[cell] > 0.0F) continue;
      int labelled = 0;
      std::uint16_t instance = 0;
      std::uint8_t label = 0, quality = 255;
      for (const std::size_t other : {cell - width, cell + width, cell - 1, cell + 1}) {
        if (!CellMask::is_object(labels[other])) continue;
        ++labelled;
        label = labels[other];
        if (!to.instances.empty()) instance = to.instances[other];
        quality = std::min(quality, to.confidence[other]);
      }
      if (labelled < 3) continue;
      labels[cell] = label, to.confidence[cell] = quality;
      if (!to.instances.empty()) to.instances[cell] = instance;
    }
}

}  // namespace holdfast
