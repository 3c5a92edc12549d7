// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "holdfast/surface/free_space.hpp"
#include "session.hpp"

namespace holdfast::bridge {

namespace {

std::int8_t cell_of(Occupancy occupancy) {
  return static_cast<std::int8_t>(occupancy == Occupancy::occupied ? 100 : occupancy == Occupancy::free ? 0 : -1);
}

/// The octree of a binary OctoMap file without the header of the file.
std::vector<std::int8_t> octree_of(const std::string& file) {
  const std::string last_line = "\ndata\n";
  const std::size_t header = file.find(last_line);
  if (header == std::string::npos) return {};
  return {file.begin() + static_cast<std::ptrdiff_t>(header + last_line.size()), file.end()};
}

void describe_grid(const GridMap& grid, const Eigen::Isometry3d& T_map_world, GridOutput& output) {
  output.has_grid = grid.width > 0 && grid.height > 0;
  output.width = static_cast<std::uint32_t>(grid.width), output.height = static_cast<std::uint32_t>(grid.height);
  output.resolution = grid.resolution;
  output.T_map_grid = T_map_world * grid.T_map_world.inverse();
  output.T_map_grid.translate(Eigen::Vector3d(grid.origin.x(), grid.origin.y(), 0.0));
  output.cells.reserve(grid.cells.size());
  for (const Occupancy occupancy : grid.cells) output.cells.push_back(cell_of(occupancy));
}

}  // namespace

std::optional<MapOutput> Session::map_output() const {
  Placement placement;
  {
    const std::lock_guard lock(mutex_);
    if (!placement_) return std::nullopt;
    placement = *placement_;
  }
  const MapSnapshot snapshot = built_->pipeline.map_snapshot();
  if (snapshot.keyframes.empty()) return std::nullopt;
  MapOutput output;
  output.stamp = stamp_;
  const Eigen::Isometry3d T_camera_base = placement.T_base_camera.inverse();
  for (const MapSnapshot::KeyFrame& keyframe : snapshot.keyframes)
    output.keyframes.emplace_back(std::llround(keyframe.timestamp * 1e9),
                                  placement.T_map_world * keyframe.T_world_camera * T_camera_base);
  for (const MapSnapshot::Point& point : snapshot.points)
    if (point.static_log_odds >= 0.0F)  // not rather moving
      output.points.emplace_back((placement.T_map_world * point.position).cast<float>());
  return output;
}

std::optional<GridOutput> Session::grid_output() const {
  Eigen::Isometry3d T_map_world;
  {
    const std::lock_guard lock(mutex_);
    if (!placement_) return std::nullopt;
    T_map_world = placement_->T_map_world;
  }
  GridOutput output;
  output.stamp = stamp_;
  std::optional<FreeSpace> space;
  TriangleMesh mesh;
  SurfaceSettings settings;
  built_->pipeline.with_surface([&](const SurfaceMap& surface) {
    if (surface.view_count() == 0) return;
    settings = surface.field().settings();
    mesh = surface.field().mesh();
    space.emplace(surface, mesh, settings.cell);
  });
  if (!space || mesh.vertices.empty()) return std::nullopt;
  output.octree = octree_of(space->octomap());
  output.T_map_octree = T_map_world;
  output.resolution = settings.cell;
  const Eigen::Matrix3d R_world_map = T_map_world.linear().transpose();
  if (const std::optional<Floor> floor = find_floor(mesh, R_world_map.col(2)))
    describe_grid(make_grid_map(*space, mesh, *floor, settings, R_world_map.col(0)), T_map_world, output);
  return output;
}

}  // namespace holdfast::bridge
