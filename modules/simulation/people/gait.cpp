// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/gait.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "curves.hpp"
#include "holdfast/simulation/limbs.hpp"

namespace holdfast::simulation {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

Quaterniond about_x(double angle) { return Quaterniond(AngleAxisd(angle, Vector3d::UnitX())); }
Quaterniond about_y(double angle) { return Quaterniond(AngleAxisd(angle, Vector3d::UnitY())); }
Quaterniond about_z(double angle) { return Quaterniond(AngleAxisd(angle, Vector3d::UnitZ())); }

void turn(Posture& posture, Bone bone, const Quaterniond& rotation) {
  Quaterniond& current = posture.rotations[index(bone)];
  current = (current * rotation).normalized();
}

/// A slow motion without a period that one would notice, about within -1 ... 1: three sines with frequencies around
/// `frequency` and phases of a seed.
double wander(double time, double frequency, std::uint64_t seed, std::uint64_t stream) {
  Random random = Random(seed).fork(stream);
  double sum = 0.0;
  for (const double ratio : {0.61, 1.0, 1.73}) {
    const double actual = frequency * ratio * random.uniform(0.9, 1.1);
    sum += std::sin(2.0 * std::numbers::pi * (actual * time + random.uniform()));
  }
  return sum / 2.2;
}

/// An upper arm raised forward, spread outwards and turned inwards about its length, and the elbow's bend.
struct ArmAngles {
  double flexion, abduction, inward, elbow, supination;
};
std::array<Quaterniond, 2> arm_rotations(Side side, const ArmAngles& angles) {
  const double s = sign(side);
  return {about_y(-s * angles.abduction) * about_x(-angles.flexion) * about_z(-s * angles.inward),
          about_x(-angles.elbow) * about_z(s * angles.supination)};
}

}  // namespace

Style::Style(Random random)
    : arm_swing(random.uniform(0.75, 1.3)),
      elbow(random.uniform(0.14, 0.3)),
      lean(random.uniform(0.02, 0.07)),
      abduction(random.uniform(0.07, 0.15)),
      step(random.uniform(0.94, 1.05)),
      toes_out(random.uniform(0.06, 0.17)),
      liveliness(random.uniform(0.75, 1.2)),
      seed(random.next()) {}

double step_length(double height, double speed) { return 0.4 * height * std::pow(speed / 1.33, 0.42); }

void add_gait(const GaitMoment& moment, const Style& style, Posture& posture) {
  const double vigour = moment.amplitude * std::pow(std::min(moment.speed, 2.0) / 1.5, 0.7);
  const double side = moment.first_side;
  const auto beat = [&](double at) { return side * std::cos(std::numbers::pi * (moment.steps - at)); };
  posture.pelvis.x() += 0.018 * moment.amplitude * beat(1.0);
  const double turned = -4.0 * degrees * vigour * beat(0.54), dropped = -3.5 * degrees * vigour * beat(0.85);
  const double chest = 5.5 * degrees * vigour * style.arm_swing * beat(0.6), lean = style.lean * moment.amplitude;
  turn(posture, Bone::pelvis, about_z(turned) * about_y(dropped) * about_x(0.3 * lean));
  turn(posture, Bone::abdomen, about_z(0.5 * (chest - turned)) * about_y(-0.6 * dropped) * about_x(0.4 * lean));
  turn(posture, Bone::chest, about_z(0.5 * (chest - turned)) * about_y(-0.5 * dropped) * about_x(0.3 * lean));
  turn(posture, Bone::neck, about_z(-0.5 * chest));
  turn(posture, Bone::head, about_z(-0.5 * chest) * about_x(-0.8 * lean));
  for (const Side arm_side : {Side::left, Side::right}) {
    // Forward when the other foot lands; the elbow bends on the way forward.
    const double swing = -sign(arm_side) * beat(0.62) * vigour * style.arm_swing;
    const double forward = 0.5 * (vigour + swing);
    const auto [upper, lower] =
        arm_rotations(arm_side, {.flexion = 3.0 * degrees + 22.0 * degrees * swing - 7.0 * degrees * vigour,
                                 .abduction = style.abduction,
                                 .inward = 0.15 + 0.2 * forward,
                                 .elbow = style.elbow + 4.0 * degrees * vigour + 18.0 * degrees * forward,
                                 .supination = 0.0});
    const Limb limb = arm(arm_side);
    posture.rotations[index(limb.upper)] = upper;
    posture.rotations[index(limb.lower)] = lower;
    posture.rotations[index(limb.end)] = about_x(-0.1);
  }
}

void add_idle(double time, const Style& style, double amount, Posture& posture) {
  const auto slow = [&](double frequency, std::uint64_t stream) {
    return amount * wander(time, frequency, style.seed, stream);
  };
  const double breath = std::sin(2.0 * std::numbers::pi * (0.25 * time + wander(0.0, 1.0, style.seed, 1)));
  posture.pelvis.x() += 0.012 * slow(0.13, 2);
  posture.pelvis.y() += 0.006 * slow(0.2, 3);
  turn(posture, Bone::pelvis, about_y(0.012 * slow(0.13, 2)));
  turn(posture, Bone::abdomen, about_y(-0.02 * slow(0.13, 2)) * about_z(0.04 * slow(0.1, 4)));
  turn(posture, Bone::chest, about_x(-0.012 * breath + 0.02 * slow(0.11, 5)) * about_z(0.05 * slow(0.12, 6)));
  turn(posture, Bone::neck, about_x(0.006 * breath) * about_z(0.13 * slow(0.15, 7)));
  turn(posture, Bone::head,
       about_z(0.2 * slow(0.17, 8)) * about_x(0.08 * slow(0.21, 9)) * about_y(0.05 * slow(0.16, 10)));
  for (const Side side : {Side::left, Side::right}) {
    const std::uint64_t stream = side == Side::left ? 20 : 30;
    turn(posture, arm(side).upper, about_x(0.05 * slow(0.14, stream) + 0.008 * breath));
    turn(posture, arm(side).lower, about_x(0.06 * slow(0.18, stream + 1)));
  }
}

void add_gesture(double time, const Style& style, double weight, Posture& posture) {
  if (weight <= 0.0) return;
  const auto wave = [&](double frequency, std::uint64_t stream) { return wander(time, frequency, style.seed, stream); };
  for (const Side side : {Side::left, Side::right}) {
    const std::uint64_t stream = side == Side::left ? 100 : 200;
    // Both hands mostly talk and rest together, the one a little more than the other.
    const double talking = 0.5 + 0.5 * std::tanh(2.5 * (0.35 + 0.8 * wave(0.16, 99) + 0.4 * wave(0.22, stream)));
    const double share = weight * (0.3 + 0.7 * talking), lively = style.liveliness * (0.35 + 0.65 * talking);
    const auto [upper, lower] =
        arm_rotations(side, {.flexion = 0.42 + lively * (0.22 * wave(0.45, stream + 1) + 0.12 * wave(1.1, stream + 2)),
                             .abduction = 0.24 + 0.13 * lively * wave(0.4, stream + 3),
                             .inward = 0.25 + 0.35 * lively * wave(0.5, stream + 4),
                             .elbow = 1.5 + lively * (0.3 * wave(0.6, stream + 5) + 0.16 * wave(1.4, stream + 6)),
                             .supination = 0.55 + 0.5 * lively * wave(0.55, stream + 7)});
    const Quaterniond hand = about_x(-0.15 + lively * (0.2 * wave(0.9, stream + 8) + 0.15 * wave(1.7, stream + 9)));
    const Limb limb = arm(side);
    const auto blend = [&](Bone bone, const Quaterniond& to) {
      posture.rotations[index(bone)] = posture.rotations[index(bone)].slerp(share, to);
    };
    blend(limb.upper, upper), blend(limb.lower, lower), blend(limb.end, hand);
  }
  turn(posture, Bone::head, about_x(0.06 * weight * wave(0.7, 300)) * about_z(0.06 * weight * wave(0.5, 301)));
}

void add_bow(double angle, Posture& posture) {
  turn(posture, Bone::pelvis, about_x(0.42 * angle));
  turn(posture, Bone::abdomen, about_x(0.33 * angle));
  turn(posture, Bone::chest, about_x(0.25 * angle));
  turn(posture, Bone::neck, about_x(-0.2 * angle));
  turn(posture, Bone::head, about_x(-0.3 * angle));
  for (const Side side : {Side::left, Side::right}) {
    Quaterniond& upper = posture.rotations[index(arm(side).upper)];
    upper = about_x(-0.95 * angle) * upper;
  }
}

}  // namespace holdfast::simulation
