// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace holdfast::simulation {

/// Turn about z [rad] that makes the face (-y) look along a direction on the floor.
double heading_of(const Eigen::Vector2d& direction);
/// The direction on the floor that a heading looks along.
Eigen::Vector2d direction_of(double heading);

/// A line over the floor past given places, corners rounded by arcs, measured by the distance travelled [m].
class Route {
 public:
  static constexpr double usual_radius = 0.6;

  /// `radius` of the corners [m], where the straights beside them leave room for it. Points that coincide with the one
  /// before are left out.
  explicit Route(const std::vector<Eigen::Vector2d>& points, double radius = usual_radius);

  double length() const { return length_; }
  /// Distances outside 0 ... length continue straight on.
  Eigen::Vector2d position(double distance) const;
  /// Heading, averaged over 0.25 m before and after so that it begins to turn gently; without jumps of 2 pi [rad].
  double heading(double distance) const;
  /// Turn per metre of heading() [rad/m].
  double curvature(double distance) const;

  /// Cuts a list of places where the corner is so sharp that one would stop and turn on the spot.
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

/// How far one has come along a route at a time: starts and ends at rest, speeds up and slows down by at most 1 m/s^2
/// and slows down in bends so that nobody turns faster than 1.9 rad/s.
class Travel {
 public:
  /// Over the first `length` metres of the route at `speed` [m/s].
  Travel(const Route& route, double length, double speed);

  double duration() const { return times_.back(); }
  double distance(double time) const;
  double speed(double time) const;
  /// When a distance is reached.
  double time(double distance) const;

 private:
  double step_ = 0.0;
  std::vector<double> speeds_, times_;  // at multiples of step_
};

}  // namespace holdfast::simulation
