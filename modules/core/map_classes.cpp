// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <utility>

#include "holdfast/core/map.hpp"

namespace holdfast {

namespace {

constexpr std::size_t most_classes = CellMask::unknown;

/// Label of a keyframe's mask at one of its features; unknown without a mask.
std::uint8_t label_at(const Frame& frame, std::uint32_t feature) {
  const CoarseView& coarse = frame.coarse;
  if (coarse.mask.labels.size() != static_cast<std::size_t>(coarse.grid.size())) return CellMask::unknown;
  const int cell = coarse.grid.cell_of(frame.x[feature], frame.y[feature]);
  return cell < 0 ? CellMask::unknown : coarse.mask.labels[static_cast<std::size_t>(cell)];
}

}  // namespace

void Map::set_classes(std::vector<std::string> names) {
  if (names.size() > most_classes) names.resize(most_classes);
  if (names == classes_) return;
  std::array<std::uint8_t, most_classes + 1> label_of;
  label_of.fill(CellMask::unknown);
  for (std::size_t old = 0; old < classes_.size(); ++old) {
    const auto same = std::find(names.begin(), names.end(), classes_[old]);
    if (same != names.end()) label_of[old] = static_cast<std::uint8_t>(same - names.begin());
  }
  points_.for_each([&](MapPointId, MapPoint& point) { point.label = label_of[point.label]; });
  classes_ = std::move(names);
}

void Map::classify_points() {
  points_.for_each([&](MapPointId, MapPoint& point) {
    std::array<std::uint32_t, most_classes> votes{};
    std::uint32_t most = 0;
    for (const Observation& observation : point.observations) {
      const std::uint8_t label = label_at(keyframes_.at(observation.keyframe).frame, observation.feature);
      if (label < classes_.size()) most = std::max(most, ++votes[label]);
    }
    if (most > 0) point.label = static_cast<std::uint8_t>(std::find(votes.begin(), votes.end(), most) - votes.begin());
  });
}

}  // namespace holdfast
