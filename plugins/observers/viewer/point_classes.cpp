// SPDX-License-Identifier: BSD-3-Clause
#include "point_classes.hpp"

namespace holdfast::viewer_plugin {

namespace {

constexpr std::uint8_t most_votes = 20;

}  // namespace

std::vector<ViewedClass> PointClasses::add(const Frame& frame) {
  std::vector<ViewedClass> changes;
  const CoarseView& coarse = frame.coarse;
  if (coarse.mask.labels.size() != static_cast<std::size_t>(coarse.grid.size())) return changes;
  for (std::size_t i = 0; i < frame.map_points.size(); ++i) {
    const MapPointId point = frame.map_points[i];
    const int cell = point.valid() ? coarse.grid.cell_of(frame.x[i], frame.y[i]) : -1;
    if (cell < 0) continue;
    const std::uint8_t label = coarse.mask.labels[static_cast<std::size_t>(cell)];
    if (label == CellMask::unknown) continue;
    if (point.slot >= votes_.size()) votes_.resize(point.slot + 1);
    Vote& vote = votes_[point.slot];
    if (vote.count > 0 && vote.generation == point.generation && vote.label != label) {
      --vote.count;
    } else if (vote.count == 0 || vote.generation != point.generation) {
      if (vote.generation != point.generation || vote.label != label || !vote.known) changes.push_back({point, label});
      vote = {point.generation, label, 1, true};
    } else if (vote.count < most_votes) {
      ++vote.count;
    }
  }
  return changes;
}

}  // namespace holdfast::viewer_plugin
