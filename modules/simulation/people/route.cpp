// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/route.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace holdfast::simulation {

using Eigen::Vector2d;

namespace {
constexpr double averaged_length = 0.25;  // to both sides, for the heading [m]
constexpr double least_radius = 0.5;      // below it one turns on the spot [m]
constexpr double sharpest_corner = 1.8;   // above it one turns on the spot [rad]
constexpr double acceleration = 1.0;      // [m/s^2]
constexpr double fastest_turn = 1.9;      // [rad/s]
constexpr double same_place = 1e-6;       // [m]

double wrapped(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

std::vector<Vector2d> without_repetition(const std::vector<Vector2d>& points) {
  std::vector<Vector2d> result;
  for (const Vector2d& point : points)
    if (result.empty() || (point - result.back()).norm() > same_place) result.push_back(point);
  return result;
}

/// The arc that rounds the corner at b: its angle and how far from b it begins.
struct Corner {
  double angle = 0.0, cut = 0.0, radius = 0.0;
};
Corner corner(const Vector2d& a, const Vector2d& b, const Vector2d& c, double radius) {
  Corner result;
  result.angle = wrapped(heading_of(c - b) - heading_of(b - a));
  const double tangent = std::tan(0.5 * std::abs(result.angle));
  result.cut = std::min({radius * tangent, 0.5 * (b - a).norm(), 0.5 * (c - b).norm()});
  result.radius = tangent > 0 ? result.cut / tangent : radius;
  return result;
}
}  // namespace

double heading_of(const Vector2d& direction) { return std::atan2(direction.x(), -direction.y()); }
Vector2d direction_of(double heading) { return {std::sin(heading), -std::cos(heading)}; }

Route::Route(const std::vector<Vector2d>& all_points, double radius) {
  const std::vector<Vector2d> points = without_repetition(all_points);
  pieces_.push_back({0.0, 0.0, points.empty() ? Vector2d::Zero() : points.front(), 0.0, 0.0, 0.0});
  if (points.size() < 2) return;
  pieces_.back().heading = heading_of(points[1] - points[0]);
  double used = 0.0;  // of the leg, by the corner at its beginning
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const bool last = i + 2 == points.size();
    const Corner bend = last ? Corner{} : corner(points[i], points[i + 1], points[i + 2], radius);
    add((points[i + 1] - points[i]).norm() - used - bend.cut, 0.0);
    if (!last && std::abs(bend.angle) > 1e-9)
      add(bend.radius * std::abs(bend.angle), (bend.angle > 0 ? 1.0 : -1.0) / bend.radius);
    used = bend.cut;
  }
}

void Route::add(double length, double curvature) {
  Piece next = pieces_.back();
  next.start = position(length_);
  next.heading += next.curvature * next.length;
  next.turned += pieces_.back().heading * next.length + 0.5 * next.curvature * next.length * next.length;
  next.from = length_;
  next.length = std::max(0.0, length);
  next.curvature = curvature;
  pieces_.push_back(next);
  length_ += next.length;
}

const Route::Piece& Route::piece(double distance) const {
  const auto after = std::partition_point(pieces_.begin() + 1, pieces_.end(),
                                          [&](const Piece& piece) { return piece.from <= distance; });
  return *(after - 1);
}

Vector2d Route::position(double distance) const {
  const Piece& on = piece(distance);
  const double along = distance - on.from, inside = std::clamp(along, 0.0, on.length);
  const double heading = on.heading + on.curvature * inside;
  Vector2d place = on.start;
  if (on.curvature == 0.0)
    place += inside * direction_of(on.heading);
  else
    place +=
        Vector2d(std::cos(on.heading) - std::cos(heading), std::sin(on.heading) - std::sin(heading)) / on.curvature;
  return place + (along - inside) * direction_of(heading);
}

double Route::heading_integral(double distance) const {
  const Piece& on = piece(distance);
  const double along = distance - on.from, inside = std::clamp(along, 0.0, on.length);
  return on.turned + on.heading * inside + 0.5 * on.curvature * inside * inside +
         (on.heading + on.curvature * inside) * (along - inside);
}

double Route::heading(double distance) const {
  return (heading_integral(distance + averaged_length) - heading_integral(distance - averaged_length)) /
         (2.0 * averaged_length);
}

double Route::curvature(double distance) const {
  constexpr double step = 0.01;
  return (heading(distance + step) - heading(distance - step)) / (2.0 * step);
}

std::vector<std::vector<Vector2d>> Route::legs(const std::vector<Vector2d>& all_points) {
  const std::vector<Vector2d> points = without_repetition(all_points);
  std::vector<std::vector<Vector2d>> result;
  if (points.size() < 2) return result;
  result.push_back({points.front()});
  for (std::size_t i = 1; i < points.size(); ++i) {
    result.back().push_back(points[i]);
    if (i + 1 == points.size()) break;
    const Corner bend = corner(points[i - 1], points[i], points[i + 1], usual_radius);
    if (std::abs(bend.angle) > sharpest_corner || (bend.radius < least_radius && std::abs(bend.angle) > 0.3))
      result.push_back({points[i]});
  }
  return result;
}

Travel::Travel(const Route& route, double length, double speed) {
  const int cells = std::max(16, static_cast<int>(std::ceil(length / 0.02)));
  step_ = length / cells;
  speeds_.resize(static_cast<std::size_t>(cells) + 1);
  for (int i = 0; i <= cells; ++i) {
    const double curvature = std::abs(route.curvature(i * step_));
    speeds_[i] = std::min(speed, fastest_turn / std::max(curvature, 1e-6));
  }
  speeds_.front() = speeds_.back() = 0.0;
  const double gain = 2.0 * acceleration * step_;
  for (int i = 1; i <= cells; ++i) speeds_[i] = std::min(speeds_[i], std::sqrt(speeds_[i - 1] * speeds_[i - 1] + gain));
  for (int i = cells - 1; i >= 0; --i)
    speeds_[i] = std::min(speeds_[i], std::sqrt(speeds_[i + 1] * speeds_[i + 1] + gain));
  times_.assign(1, 0.0);
  for (int i = 0; i < cells; ++i)
    times_.push_back(times_.back() + (step_ > 0 ? 2.0 * step_ / (speeds_[i] + speeds_[i + 1]) : 0.0));
}

double Travel::distance(double time) const {
  if (time <= 0) return 0.0;
  const double whole = step_ * static_cast<double>(speeds_.size() - 1);
  if (time >= duration()) return whole;
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  const auto i = static_cast<std::size_t>(after - times_.begin()) - 1;
  const double within = time - times_[i], rate = (speeds_[i + 1] - speeds_[i]) / (times_[i + 1] - times_[i]);
  return step_ * static_cast<double>(i) + within * (speeds_[i] + 0.5 * rate * within);
}

double Travel::speed(double time) const {
  if (time <= 0 || time >= duration()) return 0.0;
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  const auto i = static_cast<std::size_t>(after - times_.begin()) - 1;
  return speeds_[i] + (speeds_[i + 1] - speeds_[i]) * (time - times_[i]) / (times_[i + 1] - times_[i]);
}

double Travel::time(double distance) const {
  if (distance <= 0 || step_ <= 0) return 0.0;
  const auto i = static_cast<std::size_t>(distance / step_);
  if (i + 1 >= speeds_.size()) return duration();
  const double along = distance - step_ * static_cast<double>(i);
  const double rate = (speeds_[i + 1] - speeds_[i]) / (times_[i + 1] - times_[i]);
  const double final_speed = std::sqrt(std::max(0.0, speeds_[i] * speeds_[i] + 2.0 * rate * along));
  return times_[i] + (along > 0 ? 2.0 * along / (speeds_[i] + final_speed) : 0.0);
}

}  // namespace holdfast::simulation
