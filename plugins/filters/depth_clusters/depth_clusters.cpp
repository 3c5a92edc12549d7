// SPDX-License-Identifier: BSD-3-Clause
#include "depth_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace holdfast::depth_clusters_plugin {

namespace {

constexpr double min_share = 0.35;  // of the interval; motion is too small in less time

}  // namespace

DepthClusters::DepthClusters(const DepthClustersSettings& settings, const CreationContext& context)
    : settings_(settings),
      maker_(context.camera),
      noise_{static_cast<float>(settings.noise), static_cast<float>(settings.noise_growth)},
      correction_(maker_.grid(), noise_, settings.correction),
      clusters_(settings.clusters, settings.iterations) {}

void DepthClusters::keep_up(const FilterContext& context) {
  // A frame is evaluated again if its pose was estimated by another method; the first result is then discarded.
  if (!views_.empty() && views_.back().frame_index == context.frame.index) views_.pop_back();
  if (views_.empty()) return;
  if (context.previous == nullptr || context.previous->index < views_.back().frame_index ||
      context.frame.timestamp <= views_.back().timestamp) {
    views_.clear();
    return;
  }
  if (context.previous->index == views_.back().frame_index)
    views_.back().T_camera_world = context.previous->T_camera_world;
  while (views_.size() > 1 && views_[1].timestamp <= context.frame.timestamp - settings_.interval) views_.pop_front();
}

const DepthView* DepthClusters::reference(double timestamp, const Eigen::Isometry3d& T_camera_world) const {
  // The oldest view with sufficient overlap; the first candidate is the most recent one that is old enough.
  for (std::size_t i = 0; i < views_.size(); ++i) {
    if (timestamp - views_[i].timestamp < min_share * settings_.interval) return nullptr;
    const Eigen::Isometry3d motion = views_[i].T_camera_world * T_camera_world.inverse();
    const double turned = std::hypot(motion.linear()(0, 2), motion.linear()(1, 2));
    constexpr double typical_depth = 1.5;  // m
    const double moved = std::hypot(motion.translation().x(), motion.translation().y()) / typical_depth;
    constexpr double max_motion = 0.12;  // of the focal length
    const bool is_last = i + 1 == views_.size() || timestamp - views_[i + 1].timestamp < min_share * settings_.interval;
    if (turned + moved <= max_motion || is_last) return &views_[i];
  }
  return nullptr;
}

void DepthClusters::inherit(const DepthView& now, const Eigen::Isometry3d& T_camera_world) {
  const BlockGrid& grid = maker_.grid();
  inherited_.assign(now.depth.size(), 1.0F);
  if (views_.empty()) return;
  const DepthView& last = views_.back();
  const geometry::Warp warp = grid.warp(last.T_camera_world * T_camera_world.inverse());
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t block = static_cast<std::size_t>(row * grid.columns + column);
      const float depth = now.depth[block];
      if (depth <= 0.0F) continue;
      const auto warped = grid.warped(warp, column, row, depth);
      if (!warped) continue;
      const float z = warped->point.z();
      const int c = static_cast<int>(grid.column_of(warped->x) + 0.5F);
      const int r = static_cast<int>(grid.row_of(warped->y) + 0.5F);
      if (c < 0 || r < 0 || c >= grid.columns || r >= grid.rows) continue;
      const std::size_t there = static_cast<std::size_t>(r * grid.columns + c);
      if (last.depth[there] > 0.0F && std::abs(last.depth[there] - z) < 0.1F * z)
        inherited_[block] = last.static_score[there];
    }
}

void DepthClusters::add_evidence(const Frame& frame, const DepthView& now, StaticEvidence& evidence) const {
  const BlockGrid& grid = maker_.grid();
  const CoarseGrid& coarse = frame.coarse.grid;
  const std::vector<std::uint8_t>& cluster = clusters_.cluster_of();
  std::vector<float> log_odds(static_cast<std::size_t>(clusters_.count()));
  for (std::size_t k = 0; k < log_odds.size(); ++k) {
    const float score = scores_.scores()[k];
    constexpr float moves = 0.3F, doubtful = 0.6F, stands = 0.9F;
    log_odds[k] = static_cast<float>(settings_.moving_log_odds) *
                      std::clamp((doubtful - score) / (doubtful - moves), 0.0F, 1.0F) +
                  static_cast<float>(settings_.static_log_odds) * scores_.confidence()[k] *
                      std::clamp((score - doubtful) / (stands - doubtful), 0.0F, 1.0F);
  }
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const int best = block_of(grid, now, frame, i);
    if (best < 0) continue;
    const std::uint8_t name = cluster[static_cast<std::size_t>(best)];
    if (name != KMeans::none && log_odds[name] != 0.0F) evidence.add(i, log_odds[name]);
  }
  if (evidence.cells().size() != static_cast<std::size_t>(coarse.size())) return;
  for (int row = 0; row < grid.rows * BlockGrid::stride; ++row)
    for (int column = 0; column < grid.columns * BlockGrid::stride; ++column) {
      const std::uint8_t name =
          cluster[static_cast<std::size_t>((row / BlockGrid::stride) * grid.columns + column / BlockGrid::stride)];
      if (name != KMeans::none)
        evidence.add_cell(static_cast<std::size_t>(row * coarse.columns + column), log_odds[name]);
    }
}

void DepthClusters::apply(const FilterContext& context, StaticEvidence& evidence) {
  evaluated_ = false;
  if (context.T_camera_world == nullptr || context.frame.coarse.empty()) return;
  keep_up(context);
  DepthView now;
  maker_.make(context.frame, context.sensor_frame.colour, now);
  now.T_camera_world = *context.T_camera_world;
  const BlockGrid& grid = maker_.grid();
  inherit(now, *context.T_camera_world);
  now.static_score = inherited_;
  clusters_.divide(grid, now);
  if (const DepthView* past = reference(now.timestamp, now.T_camera_world)) {
    Eigen::Isometry3d T_past_now = past->T_camera_world * context.T_camera_world->inverse();
    correction_.correct(now, *past, inherited_, T_past_now);
    scores_.compare(grid, now, *past, T_past_now, noise_);
    evaluated_ = scores_.support(now, inherited_) >= static_cast<float>(settings_.support);
  }
  if (evaluated_) {
    scores_.score(grid, now, clusters_, inherited_,
                  {static_cast<float>(settings_.neighbours), static_cast<float>(settings_.memory)});
    const std::vector<std::uint8_t>& cluster = clusters_.cluster_of();
    for (std::size_t i = 0; i < cluster.size(); ++i)
      now.static_score[i] = cluster[i] == KMeans::none ? 1.0F : scores_.scores()[cluster[i]];
    add_evidence(context.frame, now, evidence);
  }
  views_.push_back(std::move(now));
}

}  // namespace holdfast::depth_clusters_plugin
