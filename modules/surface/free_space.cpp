// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "holdfast/core/error.hpp"

namespace holdfast {

namespace {

constexpr int most_evidence = 5;  // views

/// Calls `visit` with points on a triangle that are at most `spacing` apart.
template <class Visit>
void visit_points(const TriangleMesh& mesh, std::size_t triangle, double spacing, const Visit& visit) {
  const Eigen::Vector3d a = mesh.corner(triangle, 0).cast<double>();
  const Eigen::Vector3d b = mesh.corner(triangle, 1).cast<double>() - a;
  const Eigen::Vector3d c = mesh.corner(triangle, 2).cast<double>() - a;
  const double longest = std::max({b.norm(), c.norm(), (b - c).norm()});
  const int steps = std::max(static_cast<int>(std::ceil(longest / spacing)), 1);
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; i + j <= steps; ++j) visit((a + (b * i + c * j) / steps).eval());
}

/// Squared distances to the nearest zero, in cells, along one line of `count` entries with a stride.
void transform_line(float* line, std::size_t stride, int count, std::vector<float>& values, std::vector<int>& parabolas,
                    std::vector<float>& borders) {
  constexpr float far = std::numeric_limits<float>::infinity();
  const auto at = [&](int i) -> float& { return line[static_cast<std::size_t>(i) * stride]; };
  values.clear(), parabolas.clear(), borders.clear();
  for (int i = 0; i < count; ++i) values.push_back(at(i));
  const auto value = [&](int i) { return values[static_cast<std::size_t>(i)]; };
  for (int i = 0; i < count; ++i) {
    if (value(i) == far) continue;
    float border = -far;
    while (!parabolas.empty()) {
      const int last = parabolas.back();
      border = ((value(i) + static_cast<float>(i) * static_cast<float>(i)) -
                (value(last) + static_cast<float>(last) * static_cast<float>(last))) /
               static_cast<float>(2 * (i - last));
      if (border > borders.back()) break;
      parabolas.pop_back(), borders.pop_back();
      border = -far;
    }
    parabolas.push_back(i), borders.push_back(border);
  }
  if (parabolas.empty()) return;
  std::size_t k = 0;
  for (int i = 0; i < count; ++i) {
    while (k + 1 < parabolas.size() && borders[k + 1] < static_cast<float>(i)) ++k;
    const auto offset = static_cast<float>(i - parabolas[k]);
    at(i) = offset * offset + value(parabolas[k]);
  }
}

}  // namespace

FreeSpace::FreeSpace(const SurfaceMap& surface, const TriangleMesh& mesh, double resolution) : resolution_(resolution) {
  HOLDFAST_CHECK(resolution > 0.0, resolution);
  set_size(surface, mesh);
  look_through(surface);
  occupy(mesh);
  compute_distances();
}

void FreeSpace::set_size(const SurfaceMap& surface, const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const MeshVertex& vertex : mesh.vertices) box.extend(vertex.position.cast<double>());
  for (std::size_t i = 0; i < surface.view_count(); ++i) box.extend(surface.pose(i).translation());
  if (box.isEmpty()) return;
  const Eigen::Vector3d first = (box.min() / resolution_).array().floor() - 1.0;
  const Eigen::Vector3d cells = (box.max() / resolution_).array().floor() + 2.0 - first.array();
  if (cells.prod() > static_cast<double>(most_cells))
    throw Error("the free space has " + std::to_string(cells.prod() / 1e6) + " million cells of " +
                std::to_string(resolution_) + " m, at most 268 million are possible; choose larger cells");
  origin_ = resolution_ * first;
  size_ = cells.cast<int>();
  evidence_.assign(static_cast<std::size_t>(cells.prod()), 0);
  hits_.assign(evidence_.size(), 0);
}

void FreeSpace::look_through(const SurfaceMap& surface) {
  const double farthest = surface.field().settings().maximum_depth;
  // The last view that looked through a cell, and that saw a surface in it: each counts once.
  std::vector<std::uint32_t> passed(evidence_.size(), 0), hit(evidence_.size(), 0);
  const auto cell_at = [&](const Eigen::Vector3d& point) {
    const Eigen::Vector3i cell = cell_of(point);
    return contains(cell) ? index(cell) : evidence_.size();
  };
  for (std::size_t i = 0; i < surface.view_count(); ++i) {
    const KeptView& view = surface.view(i);
    const Eigen::Isometry3d& pose = surface.pose(i);
    const Camera& camera = view.only_carves() ? *view.coarse_camera : surface.camera();
    const int stride = view.only_carves() ? 2 : 4;  // [px]
    const auto number = static_cast<std::uint32_t>(i + 1);
    for (int y = 0; y < camera.height; y += stride)
      for (int x = 0; x < camera.width; x += stride) {
        const double depth = view.depth_at(x, y);
        if (depth <= 0.0) continue;
        const Eigen::Vector3d ray = pose.linear() * camera.back_project(x, y, 1.0);
        const double step = 0.7 * resolution_ / ray.norm();
        const double end = std::min(depth - resolution_, farthest);
        for (double along = step; along < end; along += step) {
          const std::size_t cell = cell_at(pose.translation() + along * ray);
          if (cell == evidence_.size() || passed[cell] == number) continue;
          passed[cell] = number;
          if (evidence_[cell] > -most_evidence) --evidence_[cell];
        }
        if (view.only_carves() || view.moves(x, y) || depth > farthest) continue;
        const std::size_t cell = cell_at(pose.translation() + depth * ray);
        if (cell == evidence_.size() || hit[cell] == number) continue;
        hit[cell] = number;
        if (hits_[cell] < most_evidence) ++hits_[cell];
      }
  }
}

void FreeSpace::occupy(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    visit_points(mesh, i, 0.5 * resolution_, [&](const Eigen::Vector3d& point) {
      const Eigen::Vector3i cell = cell_of(point);
      if (!contains(cell)) return;
      const std::size_t place = index(cell);
      evidence_[place] = static_cast<std::int8_t>(std::max<int>(hits_[place], 1));
    });
  hits_ = {};
}

void FreeSpace::compute_distances() {
  distances_.resize(evidence_.size());
  for (std::size_t i = 0; i < evidence_.size(); ++i)
    distances_[i] = evidence_[i] > 0 ? 0.0F : std::numeric_limits<float>::infinity();
  std::vector<float> values, borders;
  std::vector<int> parabolas;
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3, after = (axis + 2) % 3;
    Eigen::Vector3i cell = Eigen::Vector3i::Zero();
    const std::size_t stride = axis == 0   ? 1
                               : axis == 1 ? static_cast<std::size_t>(size_.x())
                                           : static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y());
    for (cell[next] = 0; cell[next] < size_[next]; ++cell[next])
      for (cell[after] = 0; cell[after] < size_[after]; ++cell[after])
        transform_line(distances_.data() + index(cell), stride, size_[axis], values, parabolas, borders);
  }
  for (float& distance : distances_) distance = std::sqrt(distance) * static_cast<float>(resolution_);
}

float FreeSpace::log_odds(int evidence) {
  return evidence > 0 ? std::min(0.85F * static_cast<float>(evidence), 3.5F)
                      : std::max(0.4F * static_cast<float>(evidence), -2.0F);
}

Occupancy FreeSpace::at(const Eigen::Vector3d& point) const {
  if (!point.allFinite()) return Occupancy::unknown;
  const Eigen::Vector3i cell = cell_of(point);
  return contains(cell) ? at(cell) : Occupancy::unknown;
}

double FreeSpace::distance(const Eigen::Vector3d& point) const {
  if (evidence_.empty() || !point.allFinite()) return std::numeric_limits<double>::infinity();
  const Eigen::Vector3i cell = cell_of(point);
  const Eigen::Vector3i inside = cell.cwiseMax(0).cwiseMin(size_ - Eigen::Vector3i::Ones());
  const double outside = resolution_ * (cell - inside).cast<double>().norm();
  return std::max(static_cast<double>(distances_[index(inside)]), outside);
}

std::optional<Floor> find_floor(const TriangleMesh& mesh, const Eigen::Vector3d& roughly_up) {
  Floor floor;
  floor.up = roughly_up.normalized();
  for (const double degrees : {60.0, 30.0, 15.0, 8.0}) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const Eigen::Vector3d area = mesh.area_vector(i);
      if (area.dot(floor.up) > std::cos(degrees * M_PI / 180.0) * area.norm()) sum += area;
    }
    if (sum.norm() <= 0.0) return std::nullopt;
    floor.up = sum.normalized();
  }
  constexpr double bin = 0.02;                     // [m]
  std::vector<std::pair<double, double>> heights;  // height, area
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Eigen::Vector3d area = mesh.area_vector(i);
    if (area.dot(floor.up) < 0.94 * area.norm()) continue;
    const double height = floor.up.dot(mesh.corner(i, 0).cast<double>());
    heights.emplace_back(height, area.norm());
    lowest = std::min(lowest, height), highest = std::max(highest, height);
  }
  if (heights.empty()) return std::nullopt;
  std::vector<double> areas(static_cast<std::size_t>((highest - lowest) / bin) + 3, 0.0);
  for (const auto& [height, area] : heights) areas[static_cast<std::size_t>((height - lowest) / bin) + 1] += area;
  // A plane may be on the border of two bins.
  const auto around = [&](std::size_t i) { return areas[i - 1] + areas[i] + areas[i + 1]; };
  double largest = 0.0;
  for (std::size_t i = 1; i + 1 < areas.size(); ++i) largest = std::max(largest, around(i));
  std::size_t found = 1;
  while (around(found) < 0.25 * largest) ++found;
  while (found + 2 < areas.size() && around(found + 1) > around(found)) ++found;
  const double middle = lowest + bin * (static_cast<double>(found) - 0.5);
  double sum = 0.0;
  for (const auto& [height, area] : heights)
    if (std::abs(height - middle) < 1.5 * bin) sum += height * area, floor.area += area;
  floor.height = floor.area > 0.0 ? sum / floor.area : middle;
  return floor;
}

GridMap make_grid_map(const FreeSpace& space, const TriangleMesh& mesh, const Floor& floor,
                      const SurfaceSettings& settings, const Eigen::Vector3d& ahead) {
  GridMap map;
  map.resolution = space.resolution();
  const Eigen::Vector3d level = ahead - floor.up.dot(ahead) * floor.up;
  const Eigen::Vector3d x =
      level.norm() > 0.1 ? level.normalized() : (Eigen::Vector3d::UnitX() - floor.up.x() * floor.up).normalized();
  map.T_map_world.linear().row(0) = x;
  map.T_map_world.linear().row(1) = floor.up.cross(x);
  map.T_map_world.linear().row(2) = floor.up;
  map.T_map_world.translation().z() = -floor.height;

  Eigen::AlignedBox2d box;
  for (const MeshVertex& vertex : mesh.vertices)
    box.extend((map.T_map_world * vertex.position.cast<double>()).head<2>());
  if (box.isEmpty()) return map;
  const Eigen::Array2d first = (box.min() / map.resolution).array().floor() - 1.0;
  const Eigen::Array2d cells = (box.max() / map.resolution).array().floor() + 2.0 - first;
  map.origin = map.resolution * first.matrix();
  map.width = static_cast<int>(cells.x()), map.height = static_cast<int>(cells.y());
  map.cells.assign(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height), Occupancy::unknown);

  const Eigen::Isometry3d T_world_map = map.T_map_world.inverse();
  for (int row = 0; row < map.height; ++row)
    for (int column = 0; column < map.width; ++column)
      for (double height = settings.robot_lowest; height < settings.robot_highest; height += map.resolution) {
        const Eigen::Vector2d place = map.origin + map.resolution * Eigen::Vector2d(column + 0.5, row + 0.5);
        if (!space.is_free(T_world_map * Eigen::Vector3d(place.x(), place.y(), height))) continue;
        map.cells[static_cast<std::size_t>(row * map.width + column)] = Occupancy::free;
        break;
      }
  // Obstacles last: they count more than the floor below them.
  for (const bool obstacles : {false, true})
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      visit_points(mesh, i, 0.5 * map.resolution, [&](const Eigen::Vector3d& point) {
        const Eigen::Vector3d p = map.T_map_world * point;
        const bool counts = obstacles ? p.z() >= settings.robot_lowest && p.z() <= settings.robot_highest
                                      : std::abs(p.z()) < settings.robot_lowest;
        if (!counts) return;
        const Eigen::Vector2i cell = ((p.head<2>() - map.origin) / map.resolution).array().floor().cast<int>();
        map.cells[static_cast<std::size_t>(cell.y() * map.width + cell.x())] =
            obstacles ? Occupancy::occupied : Occupancy::free;
      });
  return map;
}

NavigationMaps make_navigation_maps(const SurfaceMap& surface, const TriangleMesh& mesh) {
  const SurfaceSettings& settings = surface.field().settings();
  const FreeSpace space(surface, mesh, settings.cell);
  NavigationMaps maps;
  maps.octomap = space.octomap();
  maps.octomap_probabilities = space.octomap_probabilities();
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < surface.view_count(); ++i) up -= surface.pose(i).linear().col(1);
  if (up.norm() > 0.0) maps.floor = find_floor(mesh, up);
  if (maps.floor) maps.grid = make_grid_map(space, mesh, *maps.floor, settings);
  return maps;
}

}  // namespace holdfast
