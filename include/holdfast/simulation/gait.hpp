// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/random.hpp"
#include "holdfast/simulation/skeleton.hpp"

/// What the trunk, the head and the arms do by themselves while somebody walks, stands and talks. Each function turns
/// the joints of a posture further; angles are small, so the order hardly matters. The legs follow from where the feet
/// stand (footsteps.hpp, limbs.hpp).
namespace holdfast::simulation {

/// What tells one person's movements from another's.
struct Style {
  double arm_swing = 1.0;   ///< factor
  double elbow = 0.2;       ///< bent while the arm hangs [rad]
  double lean = 0.04;       ///< of the trunk forward while walking [rad]
  double abduction = 0.1;   ///< of the hanging arms [rad]
  double step = 1.0;        ///< factor on the length of steps
  double toes_out = 0.11;   ///< [rad]
  double liveliness = 1.0;  ///< of gestures, factor
  std::uint64_t seed = 1;   ///< of the slow motions

  Style() = default;
  explicit Style(Random random);
};

/// Length of a step [m]: 0.4 of the height at 1.33 m/s (Winter 1991) and growing with the power 0.42 of the speed
/// (Grieve and Gear 1966).
double step_length(double height, double speed);

/// Where in the sequence of steps somebody is. The foot on `first_side` comes down when `steps` is 0.54 (then 2.54 and
/// so on) and bears the body alone around 1; the other foot follows one step later.
struct GaitMoment {
  double steps = 0.0;
  double first_side = 1.0;  ///< +1 left, -1 right
  double amplitude = 0.0;   ///< 0 standing ... 1 walking
  double speed = 0.0;       ///< at which the amplitudes are taken [m/s]
};

/// Pelvis, trunk, head and arms in the step's rhythm: the pelvis turns forward with the leg that lands (4 degrees),
/// drops to the side of the swinging leg (3.5 degrees) and shifts over the standing foot (1.8 cm); the chest turns
/// against it, the head stays; the arms swing against the legs with bent elbows (Murray 1967, figures 3, 4 and 6;
/// amplitudes there for 1.5 m/s, here in proportion to the step). Also gives the arms their way to hang.
void add_gait(const GaitMoment& moment, const Style& style, Posture& posture);

/// Breathing (0.25 Hz), slow sway of the body, the head looking about; all scaled.
void add_idle(double time, const Style& style, double amount, Posture& posture);

/// Talking with the hands: raises upper arms and forearms and moves them, with pauses in which they come back half way
/// to where they were. Weight 0 ... 1.
void add_gesture(double time, const Style& style, double weight, Posture& posture);

/// Bows the trunk forward by an angle, spread over pelvis, abdomen and chest; the head follows by half and the arms
/// keep hanging.
void add_bow(double angle, Posture& posture);

}  // namespace holdfast::simulation
