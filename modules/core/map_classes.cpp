// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <utility>

#include "holdfast/core/feature_label.hpp"
#include "holdfast/core/map.hpp"

namespace holdfast {

namespace {

constexpr std::size_t most_classes = CellMask::unknown;

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
  points_.for_each([&](MapPointId, MapPoint& point) {
    point.label = label_of[point.label];
    const ClassVotes before = std::exchange(point.earlier_votes, {});
    for (const ClassVotes::Entry& entry : before.entries()) point.earlier_votes.add(label_of[entry.label], entry.votes);
  });
  classes_ = std::move(names);
}

ClassVotes Map::class_votes(const MapPoint& point) const {
  ClassVotes votes = point.earlier_votes;
  for (const Observation& observation : point.observations)
    add_vote(keyframes_.at(observation.keyframe).frame, observation.feature, votes);
  return votes;
}

void Map::add_vote(const Frame& frame, std::size_t feature, ClassVotes& votes) const {
  const std::uint8_t label = feature_label(frame, feature);
  if (label < classes_.size()) votes.add(label);
}

void Map::keep_votes(const Frame& frame) {
  if (classes_.empty()) return;
  for (std::size_t feature = 0; feature < frame.map_points.size(); ++feature)
    if (MapPoint* point = points_.find(frame.map_points[feature])) add_vote(frame, feature, point->earlier_votes);
}

void Map::classify_points() {
  points_.for_each([&](MapPointId, MapPoint& point) {
    const std::uint8_t label = class_votes(point).winner();
    if (label != CellMask::unknown) point.label = label;
  });
}

}  // namespace holdfast
