// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/instance_ids.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "holdfast/core/instance_overlaps.hpp"

namespace holdfast {

namespace {

constexpr double memory = 4.0;             // s
constexpr double share_of_position = 0.5;  // of the score
constexpr double least_score = 0.05;
constexpr double clear_overlap = 0.5;    // although positions disagree
constexpr std::size_t least_cells = 12;  // of an instance whose position says who it is

/// Numbers of cells of instances (first) and of ids (second).
InstanceOverlaps overlaps_of(const CellMask& carried, const CellMask& held) {
  InstanceOverlaps overlaps;
  const bool has_ids = held.instances.size() == carried.instances.size();
  for (std::size_t cell = 0; cell < carried.instances.size(); ++cell)
    overlaps.add(carried.instances[cell], has_ids ? held.instances[cell] : std::uint16_t{0});
  return overlaps;
}

bool may_be_same(std::uint8_t a, std::uint8_t b) { return a == b || a == CellMask::unknown || b == CellMask::unknown; }

}  // namespace

std::vector<InstanceIds::Place> InstanceIds::places_of(const SegmentedView& segmented) {
  const CellMask& mask = segmented.mask;
  const CoarseGrid& grid = segmented.view.grid;
  std::uint16_t highest = 0;
  for (const std::uint16_t instance : mask.instances) highest = std::max(highest, instance);
  std::vector<Place> places(highest + 1U);
  std::vector<Eigen::Vector3d> sums(places.size(), Eigen::Vector3d::Zero());
  std::vector<double> measured(places.size(), 0.0);
  for (std::size_t cell = 0; cell < mask.instances.size(); ++cell) {
    const std::uint16_t instance = mask.instances[cell];
    if (instance == 0) continue;
    Place& place = places[instance];
    place.label = mask.labels[cell];
    ++place.cells;
    const int column = static_cast<int>(cell) % grid.columns, row = static_cast<int>(cell) / grid.columns;
    place.in_image += Eigen::Vector2d(column, row);
    const float z = segmented.view.depth[cell];
    if (!(z > 0.0F)) continue;
    sums[instance] += z * segmented.ray(column, row);
    ++measured[instance];
  }
  for (std::size_t i = 1; i < places.size(); ++i) {
    if (places[i].cells == 0) continue;
    places[i].in_image /= static_cast<double>(places[i].cells);
    if (segmented.T_camera_world && 4.0 * measured[i] >= static_cast<double>(places[i].cells))
      places[i].in_world = segmented.T_camera_world->inverse() * Eigen::Vector3d(sums[i] / measured[i]);
  }
  return places;
}

std::optional<double> InstanceIds::nearness(const Track& track, const Place& place, double timestamp) {
  if (place.cells < least_cells || place.in_world.has_value() != track.place.in_world.has_value()) return std::nullopt;
  const double unseen = std::max(0.0, timestamp - track.last_seen);
  if (track.place.in_world && place.in_world) {
    constexpr double longest_prediction = 1.0;                         // s
    constexpr double gate_at_once = 0.3, growth = 0.9, largest = 2.0;  // m, m/s, m
    const double gate = std::min(gate_at_once + growth * unseen, largest);
    const Eigen::Vector3d predicted = *track.place.in_world + std::min(unseen, longest_prediction) * track.velocity;
    // Either it went on or it stopped.
    const double distance =
        std::min((*place.in_world - predicted).norm(), (*place.in_world - *track.place.in_world).norm());
    if (distance > gate) return std::nullopt;
    return share_of_position * (1.0 - distance / gate);
  }
  const double size = std::sqrt(static_cast<double>(std::max(place.cells, track.place.cells)));
  const double gate = size * (0.5 + unseen), distance = (place.in_image - track.place.in_image).norm();
  if (distance > gate) return std::nullopt;
  return share_of_position * (1.0 - distance / gate);
}

std::vector<InstanceIds::Candidate> InstanceIds::candidates(const std::vector<Place>& places, const CellMask& carried,
                                                            const CellMask& held, double timestamp) const {
  const InstanceOverlaps overlaps = overlaps_of(carried, held);
  std::vector<Candidate> result;
  for (std::size_t i = 1; i < places.size(); ++i) {
    if (places[i].cells == 0) continue;
    for (std::size_t k = 0; k < tracks_.size(); ++k) {
      if (!may_be_same(tracks_[k].place.label, places[i].label)) continue;
      const double iou = overlaps.iou(i, tracks_[k].id);
      const std::optional<double> near = nearness(tracks_[k], places[i], timestamp);
      if (!near && places[i].in_world && tracks_[k].place.in_world && iou < clear_overlap) continue;
      const double score = iou + near.value_or(0.0);
      if (score > least_score) result.push_back({score, i, k});
    }
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  return result;
}

void InstanceIds::update(Track& track, const Place& place, double timestamp) {
  const double interval = timestamp - track.last_seen;
  constexpr double shortest = 0.01;  // s
  if (track.place.in_world && place.in_world && interval > shortest) {
    const Eigen::Vector3d velocity = (*place.in_world - *track.place.in_world) / interval;
    constexpr double smoothing = 0.4;  // s
    track.velocity += interval / (interval + smoothing) * (velocity - track.velocity);
    constexpr double fastest = 2.0;  // m/s; faster ones are changes of the visible part
    if (track.velocity.norm() > fastest) track.velocity *= fastest / track.velocity.norm();
  }
  const std::optional<Eigen::Vector3d> last_known = track.place.in_world;
  track.place = place;
  if (!place.in_world || place.cells < least_cells) track.place.in_world = last_known;
  track.last_seen = std::max(track.last_seen, timestamp);
}

std::vector<std::uint16_t> InstanceIds::assign(const SegmentedView& segmented, const CellMask& carried,
                                               const CellMask& held) {
  const double timestamp = segmented.timestamp;
  const std::set<std::uint16_t> still_held(held.instances.begin(), held.instances.end());
  std::erase_if(tracks_, [&](const Track& track) {
    return timestamp - track.last_seen > memory && !still_held.contains(track.id);
  });
  const std::vector<Place> places = places_of(segmented);
  std::vector<std::uint16_t> ids(places.size(), 0);
  std::vector<std::uint8_t> is_taken(tracks_.size(), 0);
  for (const Candidate& candidate : candidates(places, carried, held, timestamp)) {
    if (ids[candidate.instance] != 0 || is_taken[candidate.track] != 0) continue;
    Track& track = tracks_[candidate.track];
    is_taken[candidate.track] = 1;
    ids[candidate.instance] = track.id;
    update(track, places[candidate.instance], timestamp);
  }
  for (std::size_t i = 1; i < places.size(); ++i) {
    if (places[i].cells < least_cells || ids[i] != 0) continue;
    ids[i] = next_id_;
    next_id_ = next_id_ == 65535 ? std::uint16_t{1} : static_cast<std::uint16_t>(next_id_ + 1);
    tracks_.push_back({ids[i], places[i], Eigen::Vector3d::Zero(), timestamp});
  }
  return ids;
}

}  // namespace holdfast
