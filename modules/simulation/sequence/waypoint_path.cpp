// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/waypoint_path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "full_turn.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/simulation/camera_path.hpp"

namespace holdfast::simulation {

using Eigen::Vector3d;

namespace {
constexpr double spacing = 0.02;      // of samples [m]
constexpr double gaze_window = 0.9;   // of each moving average over the heading [m]
constexpr double ramp = 1.0;          // time to start and to stop at the ends of an open path [s]
constexpr double turning_rate = 0.5;  // mean rate of turning round at the ends [rad/s]

double smoothstep(double t) { return t * t * (3.0 - 2.0 * t); }

// Distance after `time` of going `length` at `speed`, starting and stopping within `ramp`.
double travel(double time, double length, double speed) {
  const double total = length / speed + ramp;
  const auto start = [&](double t) {  // the integral of smoothstep
    const double share = t / ramp;
    return speed * ramp * (share * share * share - 0.5 * share * share * share * share);
  };
  time = std::clamp(time, 0.0, total);
  if (time < ramp) return start(time);
  if (time > total - ramp) return length - start(total - time);
  return speed * (time - 0.5 * ramp);
}

std::vector<Vector3d> sampled(const std::vector<Vector3d>& places, bool closed) {
  std::vector<Vector3d> points;
  const std::size_t legs = closed ? places.size() : places.size() - 1;
  for (std::size_t i = 0; i < legs; ++i) {
    const Vector3d &from = places[i], &to = places[(i + 1) % places.size()];
    const int count = std::max(1, static_cast<int>(std::lround((to - from).norm() / spacing)));
    for (int k = 0; k < count; ++k) points.push_back(from + (to - from) * (static_cast<double>(k) / count));
  }
  if (!closed) points.push_back(places.back());
  return points;
}

// Values of a line beyond its ends: a closed one goes round (`winding` is added per round), an open one is continued
// by reflection in its end, so that averaging leaves the end where it is.
template <class T>
T beyond(const std::vector<T>& values, long i, bool closed, const T& winding) {
  const long count = static_cast<long>(values.size());
  if (i >= 0 && i < count) return values[static_cast<std::size_t>(i)];
  if (closed)
    return i < 0 ? T(beyond(values, i + count, closed, winding) - winding)
                 : T(beyond(values, i - count, closed, winding) + winding);
  const T& end = i < 0 ? values.front() : values.back();
  const long mirrored = std::clamp(i < 0 ? -i : 2 * (count - 1) - i, 0L, count - 1);
  return T(2.0 * end - values[static_cast<std::size_t>(mirrored)]);
}

template <class T>
std::vector<T> moving_average(const std::vector<T>& values, long half, bool closed, const T& winding) {
  std::vector<T> result;
  result.reserve(values.size());
  for (long i = 0; i < static_cast<long>(values.size()); ++i) {
    T sum = beyond(values, i, closed, winding);
    for (long k = 1; k <= half; ++k) {
      sum += beyond(values, i - k, closed, winding);
      sum += beyond(values, i + k, closed, winding);
    }
    result.push_back(T(sum / static_cast<double>(2 * half + 1)));
  }
  return result;
}

// Catmull and Rom's cubic through equally spaced values.
template <class T>
T interpolate(const T& before, const T& from, const T& to, const T& after, double t) {
  return T(from + 0.5 * t *
                      ((to - before) + t * ((2.0 * before - 5.0 * from + 4.0 * to - after) +
                                            t * (3.0 * (from - to) + after - before))));
}

[[noreturn]] void refuse(const std::string& message) { throw ConfigurationError(SourceLocation{}, message); }

void check(const Waypoints& waypoints) {
  const bool closed = waypoints.closed;
  const std::vector<Vector3d>& places = waypoints.places;
  std::ostringstream text;
  if (places.size() < (closed ? 3U : 2U)) {
    text << "a camera path past " << places.size() << " places; expected at least "
         << (closed ? "three for one that is closed" : "two");
    refuse(text.str());
  }
  if (!(waypoints.speed > 0.0) || !std::isfinite(waypoints.speed) || !(waypoints.rounding >= 0.0)) {
    text << "a camera path at " << waypoints.speed << " m/s with corners rounded over " << waypoints.rounding
         << " m; expected a positive speed and a rounding of at least 0";
    refuse(text.str());
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i + 1 == places.size() && !closed) break;
    const std::size_t next = (i + 1) % places.size();
    if (!((places[next] - places[i]).norm() > 0.05)) {
      text << "places " << i + 1 << " and " << next + 1
           << " of a camera path are less than 5 cm apart; expected each to lie away from the one before";
      refuse(text.str());
    }
  }
}

/// Refuses a line that passes right above or below the target of the gaze.
void check_target(const Waypoints& waypoints, const std::vector<Vector3d>& points) {
  if (!waypoints.target) return;
  for (const Vector3d& point : points)
    if ((point - *waypoints.target).head<2>().norm() < 0.1)
      refuse(
          "a camera path passes less than 10 cm from above or below the place that it looks at, where level has no "
          "meaning; expected a target beside the way");
}
}  // namespace

Eigen::Isometry3d look_along(const Vector3d& eye, double heading, double down) {
  return look_at(
      eye, eye + Vector3d(std::cos(heading) * std::cos(down), std::sin(heading) * std::cos(down), -std::sin(down)));
}

WaypointPath::WaypointPath(const Waypoints& waypoints) : waypoints_(waypoints) {
  check(waypoints_);
  const bool closed = waypoints_.closed;
  const Vector3d still = Vector3d::Zero();
  std::vector<Vector3d> points = sampled(waypoints_.places, closed);
  const long half = std::min<long>(std::lround(0.5 * waypoints_.rounding / spacing), static_cast<long>(points.size()));
  for (int pass = 0; pass < 2; ++pass) points = moving_average(points, half, closed, still);
  check_target(waypoints_, points);
  if (closed) points.push_back(points.front());
  resample(points);
  find_headings();
}

void WaypointPath::resample(const std::vector<Vector3d>& points) {
  // Rounding shortens the line at corners, so its samples are no longer at equal distances.
  std::vector<double> way = {0.0};
  for (std::size_t i = 1; i < points.size(); ++i) way.push_back(way.back() + (points[i] - points[i - 1]).norm());
  length_ = way.back();
  const int count = std::max(4, static_cast<int>(std::lround(length_ / spacing)));
  step_ = length_ / count;
  for (int i = 0, k = 0; i < (waypoints_.closed ? count : count + 1); ++i) {
    const double wanted = std::min(i * step_, length_);
    while (k + 2 < static_cast<int>(way.size()) && way[k + 1] < wanted) ++k;
    const double share = (wanted - way[k]) / std::max(1e-12, way[k + 1] - way[k]);
    positions_.push_back(points[k] + share * (points[k + 1] - points[k]));
  }
}

void WaypointPath::find_headings() {
  const bool closed = waypoints_.closed;
  const Vector3d still = Vector3d::Zero();
  const auto direction = [&](long i) {
    const Vector3d along = beyond(positions_, i + 1, closed, still) - beyond(positions_, i - 1, closed, still);
    return std::atan2(along.y(), along.x());
  };
  headings_.push_back(direction(0));
  for (long i = 1; i <= static_cast<long>(positions_.size()); ++i) {
    const double before = headings_.back();
    headings_.push_back(before + std::remainder(direction(i) - before, full_turn<double>));
  }
  winding_ = closed ? full_turn<double> * std::round((headings_.back() - headings_.front()) / full_turn<double>) : 0.0;
  headings_.pop_back();
  const long gaze_half = std::lround(0.5 * gaze_window / spacing);
  for (int pass = 0; pass < 2; ++pass) headings_ = moving_average(headings_, gaze_half, closed, winding_);
}

double WaypointPath::cycle() const {
  if (waypoints_.closed) return length_ / waypoints_.speed;
  const double angle = std::numbers::pi - 2.0 * std::abs(waypoints_.aside);
  return 2.0 * (length_ / waypoints_.speed + ramp + std::max(1.0, angle / turning_rate));
}

WaypointPath::Moment WaypointPath::moment(double time) const {
  if (waypoints_.closed) return {std::fmod(waypoints_.speed * time, length_), 0.0};
  const double half = 0.5 * cycle(), going = length_ / waypoints_.speed + ramp;
  time = std::fmod(time, 2.0 * half);
  const bool back = time >= half;
  if (back) time -= half;
  const double gone = travel(time, length_, waypoints_.speed);
  const double turned = time < going ? 0.0 : smoothstep((time - going) / (half - going));
  return {back ? length_ - gone : gone, back ? 1.0 - turned : turned};
}

double WaypointPath::walked(double time) const {
  if (waypoints_.closed) return waypoints_.speed * time;
  const double half = 0.5 * cycle();
  const double ways = std::floor(time / half);
  return ways * length_ + travel(time - ways * half, length_, waypoints_.speed);
}

Vector3d WaypointPath::position(double distance) const {
  const double place = distance / step_;
  const long i = static_cast<long>(std::floor(place));
  const Vector3d still = Vector3d::Zero();
  const auto at = [&](long k) { return beyond(positions_, k, waypoints_.closed, still); };
  return interpolate<Vector3d>(at(i - 1), at(i), at(i + 1), at(i + 2), place - static_cast<double>(i));
}

double WaypointPath::heading(double distance) const {
  const double place = distance / step_;
  const long i = static_cast<long>(std::floor(place));
  const auto at = [&](long k) { return beyond(headings_, k, waypoints_.closed, winding_); };
  return interpolate(at(i - 1), at(i), at(i + 1), at(i + 2), place - static_cast<double>(i));
}

Eigen::Isometry3d WaypointPath::pose(double time) const {
  const Moment now = moment(time);
  const Vector3d eye = position(now.distance);
  if (waypoints_.target) return look_at(eye, *waypoints_.target);
  // About one glance to each side per 6 m, a whole number on the way.
  const double glances = std::max(1.0, std::round(length_ / 6.0));
  const double swing = waypoints_.glance * std::sin(full_turn<double> * glances * now.distance / length_);
  // Turning at the end passes over the side to which the gaze is turned.
  const double side = waypoints_.aside < 0.0 ? -1.0 : 1.0;
  const double there = waypoints_.aside + swing, back = side * std::numbers::pi - waypoints_.aside + swing;
  return look_along(eye, heading(now.distance) + there + now.turned * (back - there), waypoints_.down);
}

}  // namespace holdfast::simulation
