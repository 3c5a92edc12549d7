// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <map>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/core/random.hpp"
#include "holdfast/simulation/road.hpp"
#include "holdfast/simulation/world.hpp"

namespace holdfast::simulation {

/// Pictures and vehicles that recur along a road, each painted once.
struct RoadStock {
  RoadStock(World& world, RoadKind kind, const Random& random);

  std::vector<TextureArea> asphalt, paving, grass, foliage, facades, plaster, signs;
  TextureArea metal, wood, dark;
  std::vector<Mesh> cars, lorries;  ///< origin on the ground below the middle, x ahead
};

/// Length of a stretch of road, whose pictures and things are drawn from a random stream of its own [m].
inline constexpr double stretch_length = 20.0;

/// Adds the parts of a road to a world. Ribbons follow the bends: they are built along x, with y to the left of the
/// centre line, and bent. Rigid things stand on the road's frame at their place.
class RoadBuilder {
 public:
  RoadBuilder(World& world, const RoadPlan& plan, std::uint64_t seed);

  const RoadCourse& course() const { return course_; }
  const RoadStock& stock() const { return stock_; }
  Random random(std::uint64_t stream) const { return random_.fork(stream); }

  /// Everything that stands still between the abscissae `stretch` * stretch_length and (stretch + 1) * stretch_length.
  void stretch(int number);
  /// Fields, hills and sky around a road from the abscissa `from` to `to`.
  void surroundings(double from, double to);
  /// Vehicles in all lanes around the camera.
  void traffic();

 private:
  Object& add(const std::string& class_name, const Eigen::Isometry3d& T_world_object);
  /// Bends the mesh of a ribbon that is built from x = 0 on along the course from the abscissa `from`.
  void bend(Object& object, double from) const;
  /// A horizontal ribbon of the stretch from one offset `right` to another, `left` [m].
  void lie(Object& object, double right, double left, double height, const TextureArea& area) const;
  /// An upright one with two sides and a top.
  void stand(Object& object, double right, double left, double bottom, double top, const TextureArea& area) const;

  void street_stretch(double from, Random random);
  void motorway_stretch(int number, double from, Random random);
  void houses(double from, double side, Random random);
  void car(double x, double left, bool onwards, Random random);
  void tree(double x, double left, Random random);
  void lamp(double x, double side);
  void sign(double x, double left, double width, double height, double base, Random random);
  void bridge(double x);
  void vehicle(const Mesh& mesh, const std::string& class_name,
               std::function<Eigen::Isometry3d(double)> T_world_vehicle);

  World& world_;
  RoadPlan plan_;
  RoadProfile profile_;
  RoadCourse course_;
  Random random_;
  RoadStock stock_;
  std::map<std::string, int> counts_;  // of the objects of each class
};

}  // namespace holdfast::simulation
