// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace holdfast::simulation {

/// Rotation about z [rad] that aligns the face (-y) with a direction on the floor.
double heading_of(const Eigen::Vector2d& direction);
/// The direction on the floor of a heading.
Eigen::Vector2d direction_of(double heading);

/// A path on the floor through given positions with corners rounded by arcs, parametrised by the travelled distance
/// [m].
class Route {
 public:
  static constexpr double usual_radius = 0.6;

  /// `radius` is that of the corners [m], limited by the adjacent straight segments. Duplicate consecutive points are
  /// ignored.
  explicit Route(const std::vector<Eigen::Vector2d>& points, double radius = usual_radius);

  double length() const { return length_; }
  /// Position at a distance; the path is extended straight beyond 0 ... length.
  Eigen::Vector2d position(double distance) const;
  /// Heading, averaged over 0.25 m before and after for smooth turns; without jumps of 2 pi [rad].
  double heading(double distance) const;
  /// Derivative of heading() by the distance [rad/m].
  double curvature(double distance) const;

  /// Divides a list of positions at corners so sharp that a person would stop and turn on the spot.
  static std::vector<std::vector<Eigen::Vector2d>> legs(const std::vector<Eigen::Vector2d>& points);

 private:
  struct Piece {
    double from, length;
    Eigen::Vector2d start;
    double heading, curvature;
    double turned;  ///< integral of the heading from 0 to `from`
  };
  void add(double length, double curvature);
  const Piece& piece(double distance) const;
  double heading_integral(double distance) const;

  std::vector<Piece> pieces_;
  double length_ = 0.0;
};

/// Travelled distance along a route as a function of time: starts and ends at rest, with accelerations of at most 1
/// m/s^2 and angular velocities of at most 1.9 rad/s in bends.
class Travel {
 public:
  /// Travels the first `length` metres of the route at `speed` [m/s].
  Travel(const Route& route, double length, double speed);

  double duration() const { return times_.back(); }
  double distance(double time) const;
  double speed(double time) const;
  /// Time at which a distance is reached [s].
  double time(double distance) const;

 private:
  double step_ = 0.0;
  std::vector<double> speeds_, times_;  // at multiples of step_
};

}  // namespace holdfast::simulation
