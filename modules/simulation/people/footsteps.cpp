// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/footsteps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "curves.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/simulation/route.hpp"

namespace holdfast::simulation {

using Eigen::Vector2d;
using Eigen::Vector3d;

Eigen::Quaterniond FootPose::rotation() const {
  return Eigen::AngleAxisd(heading, Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3d::UnitX());
}

FootTrack::FootTrack(const Skeleton& skeleton, const Vector2d& position, double heading)
    : toe_(-0.75 * skeleton.length(Bone::left_foot)),
      heel_(0.25 * skeleton.length(Bone::left_foot)),
      ankle_height_(skeleton.ankle_height()) {
  constexpr double ever = std::numeric_limits<double>::infinity();
  stands_.push_back({-ever, ever, position, heading, 0, 0, 0});
}

void FootTrack::step(const Step& step) {
  Stand& last = stands_.back();
  HOLDFAST_CHECK(step.lifted >= last.from && step.landed > step.lifted,
                 "lifted " << step.lifted << " landed " << step.landed << " last landing " << last.from);
  last.to = step.lifted;
  // A short stand leaves no time to roll.
  const double share = std::min(1.0, (last.to - last.from) / 0.35);
  last.push = share * step.push;
  last.strike *= share;
  // The shorter way round from the heading before.
  const double heading = last.heading + std::remainder(step.heading - last.heading, 2.0 * std::numbers::pi);
  stands_.push_back(
      {step.landed, std::numeric_limits<double>::infinity(), step.position, heading, step.strike, 0, step.lift});
}

FootPose FootTrack::standing(const Stand& stand, double time) const {
  const double duration = stand.to - stand.from;
  const double rolling_in = std::min(0.12, 0.2 * duration), rolling_out = std::min(0.45, 0.45 * duration);
  FootPose pose;
  pose.heading = stand.heading;
  double pivot = heel_;
  if (time < stand.from + rolling_in) {
    const double rest = 1.0 - (time - stand.from) / rolling_in;
    pose.pitch = -stand.strike * rest * rest * (2.0 - rest);
  } else if (time > stand.to - rolling_out) {
    const double done = 1.0 - (stand.to - time) / rolling_out;
    pose.pitch = stand.push * done * done;
    pivot = toe_;
  }
  const Vector3d local(0, pivot, -ankle_height_);
  const Vector2d pivot_on_floor = stand.position - pivot * direction_of(stand.heading);
  pose.ankle = Vector3d(pivot_on_floor.x(), pivot_on_floor.y(), 0.0) - pose.rotation() * local;
  return pose;
}

FootPose FootTrack::pose(double time) const {
  const auto after =
      std::partition_point(stands_.begin() + 1, stands_.end(), [&](const Stand& stand) { return stand.from <= time; });
  const Stand& before = *(after - 1);
  if (time <= before.to) return standing(before, time);
  const Stand& next = *after;
  constexpr double moment = 1e-5;
  const double duration = next.from - before.to, x = (time - before.to) / duration;
  const FootPose left = standing(before, before.to), right = standing(next, next.from);
  const FootPose leaving = standing(before, before.to - moment), arriving = standing(next, next.from + moment);
  // Cubic Hermite polynomials.
  const double h01 = x * x * (3.0 - 2.0 * x), h00 = 1.0 - h01;
  const double h10 = x * (1.0 - x) * (1.0 - x) * duration / moment, h11 = x * x * (x - 1.0) * duration / moment;
  FootPose pose;
  pose.planted = false;
  pose.ankle = h00 * left.ankle + h01 * right.ankle + h10 * (left.ankle - leaving.ankle) +
               h11 * (arriving.ankle - right.ankle) + Vector3d(0, 0, next.lift * bump(x));
  pose.pitch =
      h00 * left.pitch + h01 * right.pitch + h10 * (left.pitch - leaving.pitch) + h11 * (arriving.pitch - right.pitch);
  pose.heading = left.heading + (right.heading - left.heading) * h01;
  return pose;
}

}  // namespace holdfast::simulation
