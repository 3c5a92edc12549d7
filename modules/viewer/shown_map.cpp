// SPDX-License-Identifier: BSD-3-Clause
#include "shown_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "holdfast/core/cell_mask.hpp"

namespace holdfast::viewer {

namespace {

/// Changes of a point's evidence below this are not worth a message.
constexpr float smallest_evidence = 0.25F;

bool has_moved(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.translation() - b.translation()).norm() > ShownMap::smallest_move ||
         (a.linear() - b.linear()).norm() > ShownMap::smallest_move;
}

template <class Entry>
Entry& entry_at(std::vector<Entry>& entries, std::uint32_t slot) {
  if (slot >= entries.size()) entries.resize(slot + 1);
  return entries[slot];
}

/// Marks the entries that the snapshot no longer lists.
template <class Entry>
void remove_missing(std::vector<Entry>& entries, const std::vector<bool>& is_listed, std::uint64_t version) {
  for (std::size_t slot = 0; slot < entries.size(); ++slot)
    if (entries[slot].exists && !is_listed[slot]) {
      entries[slot].exists = false;
      entries[slot].version = version;
    }
}

}  // namespace

void ShownMap::update(const MapSnapshot& map, std::uint64_t version) {
  update_points(map, version);
  update_keyframes(map, version);
  std::vector<std::uint32_t> covisibility, loops;
  for (const MapSnapshot::Covisibility& edge : map.covisibility)
    covisibility.insert(covisibility.end(), {edge.older.slot, edge.newer.slot});
  for (const MapSnapshot::Loop& loop : map.loops) loops.insert(loops.end(), {loop.older.slot, loop.newer.slot});
  if (covisibility != covisibility_) {
    covisibility_ = std::move(covisibility);
    covisibility_version_ = version;
  }
  if (loops != loops_) {
    loops_ = std::move(loops);
    loops_version_ = version;
  }
}

void ShownMap::update_points(const MapSnapshot& map, std::uint64_t version) {
  std::uint32_t slots = static_cast<std::uint32_t>(points_.size());
  for (const MapSnapshot::Point& point : map.points) slots = std::max(slots, point.id.slot + 1);
  points_.resize(slots);
  std::vector<bool> is_listed(slots, false);
  for (const MapSnapshot::Point& given : map.points) {
    Point& point = points_[given.id.slot];
    is_listed[given.id.slot] = true;
    const Eigen::Vector3f position = given.position.cast<float>();
    if (point.exists && point.generation == given.id.generation &&
        (position - point.position).norm() < static_cast<float>(smallest_move) &&
        std::abs(given.static_log_odds - point.evidence) < smallest_evidence)
      continue;
    const Class known = given.id.slot < classes_.size() ? classes_[given.id.slot] : Class();
    const std::uint8_t label = known.generation == given.id.generation ? known.label : CellMask::unknown;
    point = {position, given.static_log_odds, given.id.generation, true, label, version};
  }
  remove_missing(points_, is_listed, version);
  point_count_ = map.points.size();
}

void ShownMap::add(std::span<const ViewedClass> classes, std::uint64_t version) {
  for (const auto& [id, label] : classes) {
    entry_at(classes_, id.slot) = {id.generation, label};
    if (id.slot >= points_.size()) continue;
    Point& point = points_[id.slot];
    if (!point.exists || point.generation != id.generation) continue;
    point.label = label;
    point.version = version;
  }
}

void ShownMap::update_keyframes(const MapSnapshot& map, std::uint64_t version) {
  has_corrections_ = false;
  by_time_.clear();
  for (KeyFrame& keyframe : keyframes_) keyframe.correction.reset();
  for (const MapSnapshot::KeyFrame& given : map.keyframes) {
    KeyFrame& keyframe = entry_at(keyframes_, given.id.slot);
    by_time_.emplace_back(given.timestamp, given.id.slot);
    const bool is_new = !keyframe.exists || keyframe.generation != given.id.generation;
    if (is_new)
      keyframe = {given.T_world_camera, given.T_world_camera, {}, given.timestamp, given.id.generation, true, version};
    if (has_moved(keyframe.T_world_camera, given.T_world_camera)) {
      keyframe.T_world_camera = given.T_world_camera;
      keyframe.version = version;
    }
    if (has_moved(keyframe.followed, given.T_world_camera)) {
      keyframe.correction = given.T_world_camera * keyframe.followed.inverse();
      keyframe.followed = given.T_world_camera;
      has_corrections_ = true;
    }
  }
  std::sort(by_time_.begin(), by_time_.end());
  std::vector<bool> is_listed(keyframes_.size(), false);
  for (const auto& [timestamp, slot] : by_time_) is_listed[slot] = true;
  remove_missing(keyframes_, is_listed, version);
  keyframe_count_ = map.keyframes.size();
}

const Eigen::Isometry3d* ShownMap::pose(KeyFrameId id) const {
  const bool is_shown = id.valid() && id.slot < keyframes_.size() && keyframes_[id.slot].exists &&
                        keyframes_[id.slot].generation == id.generation;
  return is_shown ? &keyframes_[id.slot].T_world_camera : nullptr;
}

std::optional<Eigen::Isometry3d> ShownMap::correction(KeyFrameId id, double timestamp) const {
  if (pose(id) != nullptr) return keyframes_[id.slot].correction;
  if (by_time_.empty()) return std::nullopt;
  auto next = std::lower_bound(by_time_.begin(), by_time_.end(), std::make_pair(timestamp, std::uint32_t{0}));
  if (next == by_time_.end() ||
      (next != by_time_.begin() && timestamp - std::prev(next)->first < next->first - timestamp))
    --next;
  return keyframes_[next->second].correction;
}

void ShownMap::describe(std::uint64_t since, Message& message) const {
  std::vector<std::uint32_t> slots;
  std::vector<float> values;
  std::vector<std::uint8_t> labels;
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  for (std::uint32_t slot = 0; slot < points_.size(); ++slot) {
    const Point& point = points_[slot];
    if (point.version <= since || (since == 0 && !point.exists)) continue;
    slots.push_back(slot);
    values.insert(values.end(),
                  {point.position.x(), point.position.y(), point.position.z(), point.exists ? point.evidence : none});
    if (!classes_.empty()) labels.push_back(point.label);
  }
  message.add("point_slots", slots);
  message.add("point_values", values);
  message.add("point_classes", labels);
  slots.clear(), values.clear();
  std::vector<double> stamps;
  for (std::uint32_t slot = 0; slot < keyframes_.size(); ++slot) {
    const KeyFrame& keyframe = keyframes_[slot];
    if (keyframe.version <= since || (since == 0 && !keyframe.exists)) continue;
    slots.push_back(slot);
    stamps.push_back(keyframe.timestamp);
    const Eigen::Vector3f t = keyframe.T_world_camera.translation().cast<float>();
    const Eigen::Quaternionf q(keyframe.T_world_camera.linear().cast<float>());
    values.insert(values.end(), {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w(), keyframe.exists ? 1.0F : 0.0F});
  }
  message.add("keyframe_slots", slots);
  message.add("keyframe_values", values);
  message.add("keyframe_stamps", stamps);
  if (covisibility_version_ > since) {
    message.json()["covisibility"] = covisibility_.size() / 2;
    message.add("covisibility", covisibility_);
  }
  if (loops_version_ > since) {
    message.json()["loops"] = loops_.size() / 2;
    message.add("loops", loops_);
  }
}

}  // namespace holdfast::viewer
