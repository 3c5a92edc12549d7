// SPDX-License-Identifier: BSD-3-Clause
#include "multi_view_depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "holdfast/core/coarse_cells.hpp"
#include "holdfast/core/depth_noise.hpp"
#include "holdfast/geometry/warp.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace holdfast::multi_view_depth_plugin {

MultiViewDepth::MultiViewDepth(const MultiViewDepthSettings& settings, const CreationContext&) : settings_(settings) {}

void MultiViewDepth::choose_keyframes(const FilterContext& context) {
  // The most overlapping keyframes of every age group: old keyframes confirm static surfaces, and slow motion is only
  // visible in keyframes that are not too recent.
  struct Age {
    double min_age;  // s
    float through;   // weight of an observation of free space
    float same;      // weight of an observation of the same surface
  };
  static constexpr std::array<Age, 4> ages{
      {{10.0, 0.6F, 1.0F}, {3.0, 1.0F, 1.0F}, {1.0, 1.0F, 0.6F}, {0.0, 1.0F, 0.2F}}};
  const int max_per_age = std::max(1, settings_.keyframes / static_cast<int>(ages.size()));
  const Eigen::Isometry3d& T_camera_world = *context.T_camera_world;
  const Eigen::Vector3d centre = T_camera_world.inverse().translation();
  const Eigen::Vector3d direction = T_camera_world.linear().row(2);

  candidates_.clear();
  context.map.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    const Frame& frame = keyframe.frame;
    if (keyframe.submap != context.submap) return;
    if (frame.coarse.empty() || !(frame.coarse.grid == context.frame.coarse.grid)) return;
    const double cosine = direction.dot(frame.T_camera_world.linear().row(2));
    const double distance = (frame.T_world_camera().translation() - centre).norm();
    constexpr double min_cosine = 0.866;  // 30 degrees, as Bescos et al. allow
    if (cosine < min_cosine || distance > settings_.reach) return;
    const double age = context.frame.timestamp - frame.timestamp;
    std::size_t group = 0;
    while (group + 1 < ages.size() && age < ages[group].min_age) ++group;
    candidates_.push_back({id, group, (1.0 - cosine) / (1.0 - min_cosine) + distance / settings_.reach});
  });
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
    if (a.group != b.group) return a.group < b.group;
    return a.cost != b.cost ? a.cost < b.cost : a.id < b.id;
  });
  views_.clear();
  int of_age = 0;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    of_age = i > 0 && candidates_[i].group == candidates_[i - 1].group ? of_age + 1 : 0;
    if (of_age >= max_per_age) continue;
    const Age& age = ages[candidates_[i].group];
    views_.push_back({&context.map.keyframe(candidates_[i].id).frame, age.through, age.same});
  }
}

void MultiViewDepth::compare(const FilterContext& context) {
  const CoarseView& view = context.frame.coarse;
  const CoarseGrid& grid = view.grid;
  const geometry::Pinhole camera = geometry::pinhole_of(*context.frame.camera);
  columns_ = grid.columns / stride;
  rows_ = grid.rows / stride;
  const std::size_t size = static_cast<std::size_t>(columns_ * rows_);
  depth_.resize(size);
  through_.assign(size, 0.0F);
  same_.assign(size, 0.0F);
  cells_.resize(static_cast<std::size_t>(columns_));
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column)
      depth_[static_cast<std::size_t>(row * columns_ + column)] =
          view.depth[static_cast<std::size_t>(row * stride * grid.columns + column * stride)];

  const Eigen::Isometry3d T_view_world = context.T_view_world();
  const float margin = static_cast<float>(settings_.margin), slope = static_cast<float>(settings_.margin_slope);
  for (const View& other : views_) {
    const geometry::Warp warp(other.frame->T_view_world() * T_view_world.inverse(), camera);
    const std::vector<float>& there = other.frame->coarse.depth;
    const std::vector<float>& known = other.frame->coarse.static_log_odds;
    rays_x_.resize(columns_);
    for (int column = 0; column < columns_; ++column) rays_x_[column] = warp.ray_x(grid.x_of(column * stride));
    for (int row = 0; row < rows_; ++row) {
      const float* depths = depth_.data() + static_cast<std::ptrdiff_t>(row) * columns_;
      warp.row(rays_x_, warp.ray_y(grid.y_of(row * stride)), Eigen::Map<const Eigen::ArrayXf>(depths, columns_),
               warped_);
      // Not at the border, because is_seen_through() reads the cells around.
      find_cells(grid, {warped_.x.data(), cells_.size()}, {warped_.y.data(), cells_.size()}, cells_, 1);
      for (int column = 0; column < columns_; ++column) {
        const float z = warped_.z[column];
        if (depths[column] == 0.0F || !warp.is_visible(z)) continue;
        if (cells_[static_cast<std::size_t>(column)] < 0) continue;
        const std::size_t block = static_cast<std::size_t>(row * columns_ + column);
        const std::size_t cell = static_cast<std::size_t>(cells_[static_cast<std::size_t>(column)]);
        const float seen = there[cell];
        if (seen == 0.0F) continue;
        if (std::abs(seen - z) < depth_noise::same_in_view(z)) {
          if (known.empty() || known[cell] >= 0.0F) same_[block] += other.same;
          continue;
        }
        const float limit = z + margin + slope * z;
        if (seen < limit) continue;
        if (geometry::is_seen_through(there, grid.columns, static_cast<int>(cell), limit))
          through_[block] += other.through;
      }
    }
  }
}

void MultiViewDepth::grow() {
  const std::size_t size = static_cast<std::size_t>(columns_ * rows_);
  score_.resize(size);
  moving_.assign(size, 0);
  for (std::size_t i = 0; i < size; ++i) score_[i] = same_[i] - 2.0F * through_[i];
  front_.clear();
  for (int row = 1; row + 1 < rows_; ++row)
    for (int column = 1; column + 1 < columns_; ++column) {
      const int block = row * columns_ + column;
      if (score_[static_cast<std::size_t>(block)] > -1.0F) continue;
      int beside = 0;
      for (int dr = -1; dr <= 1; ++dr)
        for (int dc = -1; dc <= 1; ++dc)
          beside += score_[static_cast<std::size_t>(block + dr * columns_ + dc)] <= -1.0F ? 1 : 0;
      if (beside >= 4) front_.push_back(block);  // itself and three more
    }
  for (const int block : front_) moving_[static_cast<std::size_t>(block)] = 1;
  for (int step = 0; step < settings_.growth && !front_.empty(); ++step) {
    next_front_.clear();
    for (const int block : front_) {
      const int column = block % columns_, row = block / columns_;
      const float depth = depth_[static_cast<std::size_t>(block)];
      for (const auto& [dc, dr] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const int c = column + dc, r = row + dr;
        if (c < 0 || r < 0 || c >= columns_ || r >= rows_) continue;
        const std::size_t other = static_cast<std::size_t>(r * columns_ + c);
        if (moving_[other] != 0 || depth_[other] == 0.0F) continue;
        if (score_[other] >= static_cast<float>(settings_.confirmed_score)) continue;
        if (std::abs(depth_[other] - depth) > depth_noise::continues_block(depth)) continue;
        moving_[other] = 1;
        next_front_.push_back(r * columns_ + c);
      }
    }
    front_.swap(next_front_);
  }
}

void MultiViewDepth::evaluate_features(const FilterContext& context, StaticEvidence& evidence) const {
  const Frame& frame = context.frame;
  // If much of the view moves, surfaces without confirmation are likely to move as well.
  std::size_t deep = 0, moved = 0;
  for (std::size_t i = 0; i < depth_.size(); ++i) {
    deep += depth_[i] > 0.0F ? 1 : 0;
    moved += moving_[i];
  }
  const float share = deep == 0 ? 0.0F : static_cast<float>(moved) / static_cast<float>(deep);
  const float crowd = frame.coarse.mask.empty() ? static_cast<float>(settings_.crowd_log_odds) * share : 0.0F;
  const CoarseGrid& grid = frame.coarse.grid;
  const float moving = static_cast<float>(settings_.moving_log_odds);
  const float standing = static_cast<float>(settings_.static_log_odds);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const int column = grid.column_of(frame.x[i]) / stride, row = grid.row_of(frame.y[i]) / stride;
    if (frame.x[i] < grid.left || frame.y[i] < grid.top || column >= columns_ || row >= rows_) continue;
    // The block with the depth of the feature, for features at a depth edge.
    int best = row * columns_ + column;
    if (frame.has_depth(i)) {
      float min_difference =
          std::abs(depth_[static_cast<std::size_t>(best)] - frame.depth[i]) - depth_noise::same_in_view(frame.depth[i]);
      for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1) && min_difference > 0.0F; ++r)
        for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column + 1); ++c) {
          const float difference = std::abs(depth_[static_cast<std::size_t>(r * columns_ + c)] - frame.depth[i]) -
                                   depth_noise::same_in_view(frame.depth[i]);
          if (difference < min_difference) min_difference = difference, best = r * columns_ + c;
        }
    }
    const std::size_t block = static_cast<std::size_t>(best);
    const float reach = static_cast<float>(settings_.edge) * frame.pyramid->scale[frame.features.octave[i]];
    if (moving_[block] != 0)
      evidence.add(i, moving);
    else if (is_at_edge(grid, frame.x[i], frame.y[i], reach))
      evidence.add(i, static_cast<float>(settings_.edge_log_odds), StaticEvidence::Kind::prior);
    else if (score_[block] > 0.0F)
      evidence.add(i, standing * std::min(1.0F, score_[block] / 2.0F));
    else if (through_[block] > 0.0F)
      evidence.add(i, 0.25F * moving);
    if (crowd < -0.1F && moving_[block] == 0 && score_[block] < static_cast<float>(settings_.confirmed_score))
      evidence.add(i, crowd, StaticEvidence::Kind::prior);
  }
}

bool MultiViewDepth::is_at_edge(const CoarseGrid& grid, float x, float y, float reach) const {
  const int left = std::max(0, grid.column_of(x - reach) / stride), right = grid.column_of(x + reach) / stride;
  const int top = std::max(0, grid.row_of(y - reach) / stride), bottom = grid.row_of(y + reach) / stride;
  for (int row = top; row <= std::min(bottom, rows_ - 1); ++row)
    for (int column = left; column <= std::min(right, columns_ - 1); ++column)
      if (moving_[static_cast<std::size_t>(row * columns_ + column)] != 0) return true;
  return false;
}

void MultiViewDepth::evaluate_points(const FilterContext& context, StaticEvidence& evidence) {
  // A map point in front of the observed surface no longer exists.
  const Frame& frame = context.frame;
  const CoarseGrid& grid = frame.coarse.grid;
  const Camera& camera = *frame.camera;
  const Eigen::Isometry3d T_view_world = context.T_view_world();
  const float margin = static_cast<float>(settings_.margin), slope = static_cast<float>(settings_.margin_slope);
  evaluated_.assign(context.map.points().slot_count(), 0);
  int left = settings_.point_keyframes;
  for (auto view = views_.rbegin(); view != views_.rend() && left > 0; ++view, --left)
    for (const MapPointId id : view->frame->map_points) {
      if (!id.valid() || evaluated_[id.slot] != 0) continue;
      evaluated_[id.slot] = 1;
      const MapPoint* point = context.map.find_point(id);
      if (point == nullptr) continue;
      const Eigen::Vector3d in_camera = T_view_world * point->position;
      if (in_camera.z() < 0.1) continue;
      const Eigen::Vector2d pixel = camera.project(in_camera);
      const int c = grid.column_of(static_cast<float>(pixel.x())), r = grid.row_of(static_cast<float>(pixel.y()));
      if (c < 1 || r < 1 || c + 1 >= grid.columns || r + 1 >= grid.rows) continue;
      const float z = static_cast<float>(in_camera.z());
      const float limit = z + margin + slope * z;
      if (geometry::is_seen_through(frame.coarse.depth, grid.columns, r * grid.columns + c, limit))
        evidence.add_point(id, static_cast<float>(settings_.moving_log_odds));
    }
}

void MultiViewDepth::apply(const FilterContext& context, StaticEvidence& evidence) {
  if (context.T_camera_world == nullptr || context.frame.coarse.empty()) return;
  choose_keyframes(context);
  if (views_.empty()) return;
  compare(context);
  grow();
  evaluate_features(context, evidence);
  evaluate_points(context, evidence);
  evaluate_cells(context.frame.coarse.grid, evidence);
}

void MultiViewDepth::evaluate_cells(const CoarseGrid& grid, StaticEvidence& evidence) const {
  if (evidence.cells().size() != static_cast<std::size_t>(grid.size())) return;
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const std::size_t block = static_cast<std::size_t>(row * columns_ + column);
      const bool is_moving = moving_[block] != 0;
      if (!is_moving && !(score_[block] > 0.0F)) continue;
      const float log_odds = is_moving
                                 ? static_cast<float>(settings_.moving_log_odds)
                                 : static_cast<float>(settings_.static_log_odds) * std::min(1.0F, score_[block] / 2.0F);
      for (int r = row * stride; r < (row + 1) * stride; ++r)
        for (int c = column * stride; c < (column + 1) * stride; ++c)
          evidence.add_cell(static_cast<std::size_t>(r * grid.columns + c), log_odds);
    }
}

}  // namespace holdfast::multi_view_depth_plugin

HOLDFAST_PLUGIN(multi_view_depth, registry) {
  registry.add<holdfast::DynamicFilter, holdfast::multi_view_depth_plugin::MultiViewDepth,
               holdfast::MultiViewDepthSettings>(
      {.name = holdfast::MultiViewDepthSettings::module,
       .summary = "Compares the depth of the frame with that of keyframes: a surface in observed free space moves.",
       .paper = "Bescos, Facil, Civera, Neira: DynaSLAM: Tracking, Mapping and Inpainting in Dynamic Scenes. IEEE "
                "Robotics and Automation Letters 3(4), 2018, section III-B"});
}
