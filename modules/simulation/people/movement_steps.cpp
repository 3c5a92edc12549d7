// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <utility>

#include "movement.hpp"

namespace holdfast::simulation {

using Eigen::Vector2d;

namespace {
Side other(Side side) { return side == Side::left ? Side::right : Side::left; }
Vector2d to_the_left(double heading) { return {std::cos(heading), std::sin(heading)}; }
constexpr double walking_width = 0.028;   // from the line of travel to an ankle, as a share of the height
constexpr double standing_width = 0.052;  // the hips' width
constexpr double widening = 0.25;         // of steps in bends, per step's length and turn [1/rad]
}  // namespace

Movement::Movement(const Skeleton& skeleton, const Style& style, const Vector2d& at, double heading)
    : skeleton_(skeleton),
      style_(style),
      feet_{FootTrack(skeleton, at + standing_width * skeleton.physique().height * to_the_left(heading),
                      heading + style.toes_out),
            FootTrack(skeleton, at - standing_width * skeleton.physique().height * to_the_left(heading),
                      heading - style.toes_out)},
      next_foot_(style.seed % 2 == 0 ? Side::left : Side::right) {
  last_.position = at;
  last_.heading = heading;
}

void Movement::add(double duration, std::function<Stance(double)> stance) {
  if (duration <= 0.0) return;
  pieces_.push_back({end_, end_ + duration, std::move(stance)});
  end_ += duration;
}

void Movement::wait(double duration) {
  add(duration, [stance = last_](double) { return stance; });
}

/// `step.position` is the place on the line of travel, its heading that of the body.
void Movement::step(Side side, FootTrack::Step step, double width) {
  step.position += sign(side) * width * to_the_left(step.heading);
  step.heading += sign(side) * style_.toes_out;
  feet_[side == Side::right].step(step);
  next_foot_ = other(side);
}

void Movement::turn(double heading) {
  constexpr double fastest = 115.0 * degrees;
  const Stance before = last_;
  const double angle = std::remainder(heading - before.heading, 2.0 * std::numbers::pi);
  if (std::abs(angle) < 1e-9) return;
  const double duration = std::max(0.9, 1.875 * std::abs(angle) / fastest), start = end_;
  add(duration, [=](double time) {
    Stance stance = before;
    stance.heading += angle * ease((time - start) / duration);
    return stance;
  });
  last_.heading += angle;
  Side side = next_foot_;
  const int rounds = static_cast<int>(std::ceil(std::abs(angle) / (75.0 * degrees)));
  const double beat = duration / (2.0 * rounds);
  for (int k = 0; k < 2 * rounds; ++k, side = other(side))
    step(side,
         {.lifted = start + (k + 0.06) * beat,
          .landed = start + (k + 0.94) * beat,
          .position = before.position,
          .heading = before.heading + angle * (k / 2 + 1) / rounds,
          .push = 0.12,
          .strike = 0.0,
          .lift = 0.045},
         standing_width * skeleton_.physique().height);
}

void Movement::walk(const Travel& travel, double length, double speed, const std::function<Stance(double)>& pose) {
  if (length <= 0.0) return;
  // As long as befits the speed that bends and short ways leave.
  const double height = skeleton_.physique().height, start = end_;
  const double usual_speed = std::min(speed, length / std::max(0.1, travel.duration() - 0.5 * speed));
  const double longest = 1.08 * style_.step * step_length(height, usual_speed);
  const int count = std::max(1, static_cast<int>(std::ceil(length / longest)));
  const double stride = length / count, vigour = std::min(1.0, stride / 0.6);
  const Side first = next_foot_;
  add(travel.duration(), [=](double time) {
    const double distance = travel.distance(time - start), steps = distance / stride;
    Stance stance = pose(distance);
    stance.gait = {.steps = steps,
                   .first_side = sign(first),
                   .amplitude = vigour * ease(std::min(steps, count - steps) / std::min(1.0, 0.5 * count)),
                   .speed = speed};
    return stance;
  });
  last_ = pose(length);
  last_.gait = {};
  const auto when = [&](double steps) { return start + travel.time(steps * stride); };
  for (int i = 0; i <= count; ++i) {
    const bool opening = i == 0, closing = i == count;
    const double place = std::min(i + 1, count);
    const Stance there = pose(place * stride);
    const double bend =
        pose(std::min(place + 0.5, 1.0 * count) * stride).heading - pose(std::max(place - 0.5, 0.0) * stride).heading;
    step(i % 2 == 0 ? first : other(first),
         {.lifted = when(opening   ? 0.08
                         : closing ? i - 0.4
                                   : i - 0.22),
          .landed = when(closing ? i : i + 0.54),
          .position = there.position,
          .heading = there.heading,
          .push = (opening ? 0.35 : 0.66) * vigour,
          .strike = (closing ? 0.05 : 0.33) * vigour,
          .lift = opening || closing ? 0.03 : 0.005 + 0.025 * (1.0 - vigour)},
         place < count ? walking_width * height + std::min(0.06, widening * stride * std::abs(bend))
                       : standing_width * height);
  }
}

void Movement::shift(const Window& window, const Vector2d& offset) {
  const Stance before = last_;
  add(window.gone - end_, [=](double time) {
    Stance stance = before;
    stance.position += window.weight(time) * offset;
    return stance;
  });
}

}  // namespace holdfast::simulation
