// SPDX-License-Identifier: BSD-3-Clause
#include "dense_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace holdfast::viewer {

namespace {

/// Moves below this [m], or in the same measure of the rotation, are not worth a message.
constexpr double smallest_surface_move = 3e-3;
constexpr double growth = 1.3;  // of the cubes
constexpr std::size_t points_of_part = 5000;

std::uint64_t key_of(const Eigen::Vector3d& place, double resolution) {
  constexpr int axis_bits = 21;
  constexpr std::int64_t half = std::int64_t{1} << (axis_bits - 1), mask = 2 * half - 1;
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = std::clamp(std::floor(place[axis] / resolution), -1e9, 1e9);
    key = key << axis_bits | static_cast<std::uint64_t>((static_cast<std::int64_t>(cell) + half) & mask);
  }
  return key;
}

bool is_elsewhere(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.translation() - b.translation()).norm() > smallest_surface_move ||
         (a.linear() - b.linear()).norm() > smallest_surface_move;
}

void append(const Eigen::Isometry3d& pose, std::vector<float>& values) {
  const Eigen::Vector3f t = pose.translation().cast<float>();
  const Eigen::Quaternionf q(pose.linear().cast<float>());
  values.insert(values.end(), {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()});
}

}  // namespace

void DenseCloud::thin(Surface& surface) {
  std::erase_if(surface.points, [&](const CloudPoint& point) {
    const Eigen::Vector3d place = surface.T_world_camera * Eigen::Vector3d(point.x, point.y, point.z);
    return !taken_.insert(key_of(place, resolution_)).second;
  });
  size_ += surface.points.size();
}

void DenseCloud::coarsen() {
  while (size_ > most_points) {
    resolution_ *= growth;
    taken_.clear();
    size_ = 0;
    for (Surface& surface : surfaces_) thin(surface);
  }
  std::erase_if(surfaces_, [](const Surface& surface) { return surface.points.empty(); });
  ++number_;
}

void DenseCloud::add(ViewedSurface given) {
  Surface surface{given.keyframe, given.timestamp, given.T_world_camera, std::move(given.points), 0};
  thin(surface);
  if (surface.points.empty()) return;
  surfaces_.push_back(std::move(surface));
  if (size_ > most_points) coarsen();
}

void DenseCloud::replace(const std::vector<CloudPoint>& cloud) {
  surfaces_.clear();
  taken_.clear();
  size_ = 0;
  resolution_ = finest;
  ++number_;
  for (std::size_t begin = 0; begin < cloud.size(); begin += points_of_part) {
    const std::size_t end = std::min(cloud.size(), begin + points_of_part);
    Surface part{{}, 0.0, Eigen::Isometry3d::Identity(), {}, 0};
    part.points.assign(cloud.begin() + static_cast<std::ptrdiff_t>(begin),
                       cloud.begin() + static_cast<std::ptrdiff_t>(end));
    thin(part);
    if (!part.points.empty()) surfaces_.push_back(std::move(part));
  }
  if (size_ > most_points) coarsen();
}

void DenseCloud::follow(const ShownMap& map, std::uint64_t version) {
  for (Surface& surface : surfaces_) {
    if (!surface.keyframe.valid()) continue;
    Eigen::Isometry3d wanted = surface.T_world_camera;
    if (const Eigen::Isometry3d* pose = map.pose(surface.keyframe))
      wanted = *pose;
    else if (const auto correction = map.correction(surface.keyframe, surface.timestamp))
      wanted = *correction * wanted;
    if (!is_elsewhere(wanted, surface.T_world_camera)) continue;
    surface.T_world_camera = wanted;
    surface.version = moved_version_ = version;
  }
}

bool DenseCloud::has_more(const CloudProgress& progress) const {
  if (surfaces_.empty() && progress.surfaces == 0) return false;
  return progress.number != number_ || progress.surfaces < surfaces_.size() || progress.version < moved_version_;
}

void DenseCloud::describe(CloudProgress& progress, Message& message) const {
  if (!has_more(progress)) return;
  if (progress.number != number_) {
    progress = {number_, 0, 0};
    message.json()["new_cloud"] = true;
  }
  std::vector<std::uint32_t> moved, counts;
  std::vector<float> moved_poses, poses, places;
  for (std::size_t i = 0; i < progress.surfaces; ++i)
    if (surfaces_[i].version > progress.version) {
      moved.push_back(static_cast<std::uint32_t>(i));
      append(surfaces_[i].T_world_camera, moved_poses);
    }
  std::vector<std::uint8_t> colours;
  while (progress.surfaces < surfaces_.size() && places.size() < 3 * most_in_message) {
    const Surface& surface = surfaces_[progress.surfaces++];
    counts.push_back(static_cast<std::uint32_t>(surface.points.size()));
    append(surface.T_world_camera, poses);
    for (const CloudPoint& point : surface.points) {
      places.insert(places.end(), {point.x, point.y, point.z});
      colours.insert(colours.end(), {point.red, point.green, point.blue});
    }
  }
  progress.version = moved_version_;
  message.add("moved_surfaces", moved);
  message.add("moved_surface_poses", moved_poses);
  message.add("surface_counts", counts);
  message.add("surface_poses", poses);
  message.add("surface_places", places);
  message.add("surface_colours", colours);
}

}  // namespace holdfast::viewer
