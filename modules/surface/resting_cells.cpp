// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/resting_cells.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "holdfast/core/after_loss.hpp"
#include "holdfast/core/depth_noise.hpp"

namespace holdfast {

namespace {

constexpr double interval = 0.2;        // [s]
constexpr double late_masks = 2.0;      // [s] after which the mask of a keyframe may come
constexpr std::size_t most_excess = 5;  // cells at rest for one that is not

/// Sets the log-odds of a cell to 0, and those of cells without depth around it: a filter judges blocks of cells.
template <class View>
void release(const View& view, std::size_t cell, std::vector<float>& log_odds) {
  const int column = static_cast<int>(cell) % view.grid.columns, row = static_cast<int>(cell) / view.grid.columns;
  for (int r = std::max(row - 1, 0); r <= std::min(row + 1, view.grid.rows - 1); ++r)
    for (int c = std::max(column - 1, 0); c <= std::min(column + 1, view.grid.columns - 1); ++c) {
      const auto other = static_cast<std::size_t>(r * view.grid.columns + c);
      if (other == cell || (view.depth[other] == 0.0F && log_odds[other] < 0.0F)) log_odds[other] = 0.0F;
    }
}

}  // namespace

void RestingCells::add(const Frame& frame, const FrameResult& result) {
  if (result.status == TrackingStatus::initialised || is_after_loss(result.method)) clear();
  if (result.status != TrackingStatus::tracked || frame.coarse.empty()) return;
  if (!views_.empty() && !result.is_keyframe && frame.timestamp - views_.back().timestamp < interval) return;
  views_.push_back(
      {frame.index, frame.timestamp, frame.camera, frame.coarse.grid, frame.T_view_world(), frame.coarse.depth});
  while (views_.front().timestamp < frame.timestamp - time_ - late_masks) views_.pop_front();
}

RestingCells::State RestingCells::compare(const View& view, int cell) const {
  const float depth = view.depth[static_cast<std::size_t>(cell)];
  const Eigen::Vector3d pixel(view.grid.x_of(cell % view.grid.columns), view.grid.y_of(cell / view.grid.columns), 1.0);
  const Camera& camera = *view.camera;
  const Eigen::Vector3d ray((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy, 1.0);
  const Eigen::Vector3d point = view.T_view_world.inverse() * (static_cast<double>(depth) * ray);
  bool is_confirmed = false;
  for (const View& other : views_) {
    if (other.timestamp >= view.timestamp) break;
    if (other.timestamp < view.timestamp - time_ - 0.5 * interval) continue;
    const Eigen::Vector3d there = other.T_view_world * point;
    if (there.z() < 0.1) continue;
    const int place = other.grid.cell_of(static_cast<float>(camera.fx * there.x() / there.z() + camera.cx),
                                         static_cast<float>(camera.fy * there.y() / there.z() + camera.cy));
    const float seen = place < 0 ? 0.0F : other.depth[static_cast<std::size_t>(place)];
    if (seen == 0.0F) continue;
    const auto expected = static_cast<float>(there.z());
    const float tolerance = depth_noise::same_in_view(expected);
    if (seen > expected + 2.0F * tolerance) return State::moves;
    if (std::abs(seen - expected) < tolerance && other.timestamp <= view.timestamp - 0.75 * time_) is_confirmed = true;
  }
  return is_confirmed ? State::rests : State::unknown;
}

std::vector<RestingCells::State> RestingCells::states_of(const View& view,
                                                         const std::vector<float>& static_log_odds) const {
  std::vector<State> states(view.depth.size(), State::unknown);
  for (std::size_t i = 0; i < states.size(); ++i)
    if (static_log_odds[i] < 0.0F && view.depth[i] > 0.0F) states[i] = compare(view, static_cast<int>(i));
  return states;
}

std::vector<float> RestingCells::released(std::uint64_t frame_index, const std::vector<float>& static_log_odds) const {
  std::vector<float> result = static_log_odds;
  const auto view = std::find_if(views_.begin(), views_.end(),
                                 [&](const View& candidate) { return candidate.frame_index == frame_index; });
  if (view == views_.end() || static_log_odds.size() != view->depth.size()) return result;
  const std::vector<State> states = states_of(*view, static_log_odds);
  std::vector<bool> is_done(states.size(), false);
  std::vector<std::size_t> part;
  const auto columns = static_cast<std::size_t>(view->grid.columns);
  for (std::size_t seed = 0; seed < states.size(); ++seed) {
    if (is_done[seed] || states[seed] == State::unknown) continue;
    part.assign(1, seed);
    is_done[seed] = true;
    std::size_t resting = 0, moving = 0;
    for (std::size_t next = 0; next < part.size(); ++next) {
      const std::size_t at = part[next];
      resting += states[at] == State::rests ? 1 : 0;
      moving += states[at] == State::moves ? 1 : 0;
      const auto visit = [&](std::size_t other) {
        if (is_done[other] || !(static_log_odds[other] < 0.0F) || view->depth[other] == 0.0F) return;
        if (std::abs(view->depth[other] - view->depth[at]) > depth_noise::continues_block(view->depth[at])) return;
        is_done[other] = true;
        part.push_back(other);
      };
      if (at % columns > 0) visit(at - 1);
      if (at % columns + 1 < columns) visit(at + 1);
      if (at >= columns) visit(at - columns);
      if (at + columns < states.size()) visit(at + columns);
    }
    if (2 * resting < part.size() || resting < most_excess * moving) continue;
    for (const std::size_t cell : part) release(*view, cell, result);
  }
  return result;
}

}  // namespace holdfast
