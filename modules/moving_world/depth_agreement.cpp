// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/depth_agreement.hpp"

#include <algorithm>
#include <cmath>

#include "holdfast/core/coarse_cells.hpp"
#include "holdfast/core/depth_noise.hpp"
#include "holdfast/geometry/se3.hpp"
#include "holdfast/geometry/warp.hpp"

namespace holdfast {

bool DepthAgreement::choose(const Map& map, KeyFrameId reference, double timestamp) {
  constexpr int neighbours = 20;  // in which keyframes are looked for; the strongest of those old enough are taken
  const auto max_count = static_cast<std::size_t>(settings_.depth_check_keyframes);
  keyframes_.clear();
  const KeyFrame* first = map.find_keyframe(reference);
  if (first == nullptr) return false;
  const auto take = [&](const Frame& frame) {
    if (keyframes_.size() < max_count && !frame.coarse.empty()) keyframes_.push_back(&frame);
  };
  const std::vector<KeyFrameId> covisible = map.best_covisible(reference, neighbours);
  for (const bool want_old : {true, false}) {
    if (!keyframes_.empty()) break;
    if (timestamp - first->frame.timestamp >= settings_.depth_check_age || !want_old) take(first->frame);
    for (const KeyFrameId id : covisible)
      if (const Frame& frame = map.keyframe(id).frame;
          timestamp - frame.timestamp >= settings_.depth_check_age || !want_old)
        take(frame);
  }
  return !keyframes_.empty();
}

Eigen::Isometry3d DepthAgreement::find_view(const Frame& frame, const Eigen::Isometry3d& T_camera_world,
                                            double share_there, const Eigen::Isometry3d& step) const {
  // One-dimensional search on the motion from the previous to the next frame: the best of five poses, then of two
  // between it and its neighbours.
  const auto motion = geometry::log_se3(step);
  const auto view_at = [&](double steps) { return geometry::exp_se3(steps * motion); };
  double best_steps = 0.0, best_share = share_there;
  const auto try_at = [&](double steps) {
    const double there = agreeing_share(frame, view_at(steps) * T_camera_world);
    if (there <= best_share) return;
    best_share = there;
    best_steps = steps;
  };
  for (const double steps : {-0.4, 0.4, -0.8, 0.8}) try_at(steps);
  const double centre = best_steps;
  for (const double steps : {centre - 0.2, centre + 0.2}) try_at(steps);
  return view_at(best_steps);
}

DepthAgreement::Counts DepthAgreement::count(const Frame& frame, const Eigen::Isometry3d& T_view_world) const {
  constexpr int stride = 4;  // cells
  const CoarseGrid& grid = frame.coarse.grid;
  const geometry::Pinhole camera = geometry::pinhole_of(*frame.camera);
  const int columns = std::max(0, (grid.columns - stride / 2 + stride - 1) / stride);
  const auto size = static_cast<std::size_t>(columns);
  Eigen::ArrayXf rays_x(columns), depths(columns);
  geometry::WarpedRow warped;
  std::vector<std::int32_t> cells(size);
  Counts counts;
  for (const Frame* keyframe : keyframes_) {
    if (!(keyframe->coarse.grid == grid)) continue;
    const geometry::Warp warp(keyframe->T_view_world() * T_view_world.inverse(), camera);
    const float* const seen = keyframe->coarse.depth.data();
    const bool is_evaluated = !keyframe->coarse.static_log_odds.empty();
    const float* const known = keyframe->coarse.static_log_odds.data();
    for (int i = 0; i < columns; ++i) rays_x[i] = warp.ray_x(grid.x_of(stride / 2 + i * stride));
    for (int row = stride / 2; row < grid.rows; row += stride) {
      const float* here = &frame.coarse.depth[static_cast<std::size_t>(row * grid.columns + stride / 2)];
      for (int i = 0; i < columns; ++i) depths[i] = here[i * stride];
      warp.row(rays_x, warp.ray_y(grid.y_of(row)), depths, warped);
      find_cells(grid, {warped.x.data(), size}, {warped.y.data(), size}, cells);
      for (int i = 0; i < columns; ++i) {
        const float expected = warped.z[i];
        const std::int32_t cell = cells[static_cast<std::size_t>(i)];
        if (cell < 0 || depths[i] == 0.0F || !warp.is_visible(expected)) continue;
        if (is_evaluated && known[cell] < 0.0F) continue;
        if (seen[cell] == 0.0F) continue;
        ++counts.compared;
        counts.agreeing += std::abs(seen[cell] - expected) < depth_noise::agreement(expected) ? 1 : 0;
        counts.farther += expected - seen[cell] > depth_noise::farther(expected) ? 1 : 0;
      }
    }
  }
  return counts;
}

double DepthAgreement::agreeing_share(const Frame& frame, const Eigen::Isometry3d& T_view_world) const {
  const Counts counts = count(frame, T_view_world);
  return counts.compared < settings_.depth_check_cells ? 0.0 : static_cast<double>(counts.agreeing) / counts.compared;
}

bool DepthAgreement::disagrees(const Frame& frame, const Eigen::Isometry3d& T_view_world, double least_share) const {
  const Counts counts = count(frame, T_view_world);
  return counts.compared >= settings_.depth_check_cells &&
         static_cast<double>(counts.agreeing) / counts.compared < least_share;
}

double DepthAgreement::unoccluded_share(const Frame& frame, const Eigen::Isometry3d& T_view_world) const {
  // A pose for which nearly all cells are nearer than the known surfaces is wrong, too.
  const Counts counts = count(frame, T_view_world);
  if (counts.agreeing < settings_.depth_check_cells || counts.agreeing < settings_.fallback_agreement * counts.compared)
    return 0.0;
  return static_cast<double>(counts.agreeing) / (counts.agreeing + counts.farther);
}

}  // namespace holdfast
