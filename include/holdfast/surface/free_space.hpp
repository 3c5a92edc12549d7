// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/surface/surface_map.hpp"
#include "holdfast/surface/triangle_mesh.hpp"

namespace holdfast {

enum class Occupancy : std::uint8_t { unknown, free, occupied };

/// Occupancy of the static scene in cells of a dense grid: occupied where the mesh is, free where a view looked
/// through, else unknown. Immutable after construction; any thread.
class FreeSpace {
 public:
  static constexpr std::size_t most_cells = std::size_t{1} << 28;

  /// Of the views and the mesh of a surface, in cells of side `resolution` [m]. Throws Error if the grid would have
  /// more than most_cells cells.
  FreeSpace(const SurfaceMap& surface, const TriangleMesh& mesh, double resolution);

  double resolution() const { return resolution_; }
  Occupancy at(const Eigen::Vector3d& point) const;
  /// Whether a point is known to be free.
  bool is_free(const Eigen::Vector3d& point) const { return at(point) == Occupancy::free; }
  /// Distance from the centre of a point's cell to that of the nearest occupied cell [m] (exact Euclidean distance
  /// transform; Felzenszwalb and Huttenlocher, Theory of Computing 2012): 0 in an occupied cell, infinite without any.
  /// Points outside the grid get the distance to it in addition, a lower bound.
  double distance(const Eigen::Vector3d& point) const;

  /// Number of cells of the grid, along x, y, z of the world.
  const Eigen::Vector3i& size() const { return size_; }
  Eigen::Vector3d centre_of(const Eigen::Vector3i& cell) const {
    return origin_ + resolution_ * (cell.cast<double>() + Eigen::Vector3d::Constant(0.5));
  }
  Occupancy at(const Eigen::Vector3i& cell) const {
    const int found = evidence(cell);
    return found > 0 ? Occupancy::occupied : found < 0 ? Occupancy::free : Occupancy::unknown;
  }
  /// Number of views that support the state of a cell, at most 5: positive if it is occupied, negative if it is free, 0
  /// if it is unknown.
  int evidence(const Eigen::Vector3i& cell) const { return evidence_[index(cell)]; }
  /// Log-odds of the occupancy by OctoMap's sensor model: 0.85 for each view that supports it, at most 3.5; -0.4 for
  /// each view that looked through, at least -2.
  static float log_odds(int evidence);

  /// Formats the grid as a binary OctoMap (.bt; Hornung et al., Autonomous Robots 2013).
  std::string octomap() const;
  /// Formats the grid as an OctoMap with log_odds() of each cell (.ot).
  std::string octomap_probabilities() const;

 private:
  std::size_t index(const Eigen::Vector3i& cell) const {
    return (static_cast<std::size_t>(cell.z()) * static_cast<std::size_t>(size_.y()) +
            static_cast<std::size_t>(cell.y())) *
               static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(cell.x());
  }
  Eigen::Vector3i cell_of(const Eigen::Vector3d& point) const {
    constexpr double farthest = 1e9;  // fits an int
    return ((point - origin_) / resolution_).array().floor().max(-farthest).min(farthest).cast<int>();
  }
  bool contains(const Eigen::Vector3i& cell) const {
    return (cell.array() >= 0).all() && (cell.array() < size_.array()).all();
  }
  void set_size(const SurfaceMap& surface, const TriangleMesh& mesh);
  void look_through(const SurfaceMap& surface);
  void occupy(const TriangleMesh& mesh);
  Eigen::Vector3i first_cell() const { return (origin_ / resolution_).array().round().cast<int>(); }
  void compute_distances();

  double resolution_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();  // a multiple of the resolution
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  std::vector<std::int8_t> evidence_;
  std::vector<std::uint8_t> hits_;  // number of views that saw a surface in a cell; only during construction
  std::vector<float> distances_;    // [m]
};

/// The floor of a mesh: points p with up . p = height.
struct Floor {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  double height = 0.0;  ///< [m]
  double area = 0.0;    ///< of the mesh at it [m^2]
};

/// Finds the floor: the lowest horizontal plane with at least a quarter of the area of the largest one. Up is the mean
/// of the normals within 60 degrees of `roughly_up`, such as that of the cameras. Empty without a horizontal surface.
std::optional<Floor> find_floor(const TriangleMesh& mesh, const Eigen::Vector3d& roughly_up);

/// A map of the floor for wheeled robots, as ROS's map_server reads it. x is the direction in which the camera of the
/// first view looks, y to its left, the origin is below it.
struct GridMap {
  int width = 0, height = 0;
  double resolution = 0.05;                          ///< [m]
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< lower left corner of cell (0, 0) [m]
  Eigen::Isometry3d T_map_world = Eigen::Isometry3d::Identity();
  std::vector<Occupancy> cells;  ///< row by row from the lowest y

  Occupancy at(int x, int y) const { return cells[static_cast<std::size_t>(y * width + x)]; }
};

/// A cell is occupied if there is surface between SurfaceSettings::robot_lowest and robot_highest, free if the floor or
/// free space in the band was seen and no such surface, else unknown. x of the map is the part along the floor of
/// `ahead` (world), by default the viewing direction of the first camera.
GridMap make_grid_map(const FreeSpace& space, const TriangleMesh& mesh, const Floor& floor,
                      const SurfaceSettings& settings, const Eigen::Vector3d& ahead = Eigen::Vector3d::UnitZ());

/// Maps for navigation.
struct NavigationMaps {
  std::optional<Floor> floor;  ///< empty without a horizontal surface; then there is no grid
  GridMap grid;
  std::string octomap;                ///< see FreeSpace::octomap
  std::string octomap_probabilities;  ///< see FreeSpace::octomap_probabilities
};

/// Makes the maps of a surface and its mesh. Up is roughly that of the cameras.
NavigationMaps make_navigation_maps(const SurfaceMap& surface, const TriangleMesh& mesh);

/// Formats the image of a grid map: binary PGM with 0 = occupied, 254 = free, 205 = unknown, the largest y first.
std::string grid_map_pgm(const GridMap& map);
/// Formats the description of a grid map; `image` is the name of its image.
std::string grid_map_yaml(const GridMap& map, const std::string& image);

}  // namespace holdfast
