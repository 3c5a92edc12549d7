// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/random.hpp"
#include "holdfast/simulation/skeleton.hpp"

/// Secondary motion of trunk, head and arms while a person walks, stands and talks. Each function adds rotations to the
/// joints of a posture; the angles are small, so that the order is nearly irrelevant. The legs are computed from the
/// positions of the feet (footsteps.hpp, limbs.hpp).
namespace holdfast::simulation {

/// Individual parameters of a person's movements.
struct Style {
  double arm_swing = 1.0;   ///< factor
  double elbow = 0.2;       ///< flexion of the hanging arm [rad]
  double lean = 0.04;       ///< of the trunk forward while walking [rad]
  double abduction = 0.1;   ///< of the hanging arms [rad]
  double step = 1.0;        ///< factor on the length of steps
  double toes_out = 0.11;   ///< [rad]
  double liveliness = 1.0;  ///< of gestures, factor
  std::uint64_t seed = 1;   ///< of the slow motions

  Style() = default;
  explicit Style(Random random);
};

/// Length of a step [m]: 0.4 of the height at 1.33 m/s (Winter 1991), proportional to the power 0.42 of the speed
/// (Grieve and Gear 1966).
double step_length(double height, double speed);

/// Phase of the gait. The foot on `first_side` lands when `steps` is 0.54 (then 2.54 and so on) and is in single
/// support around 1; the other foot follows one step later.
struct GaitMoment {
  double steps = 0.0;
  double first_side = 1.0;  ///< +1 left, -1 right
  double amplitude = 0.0;   ///< 0 standing ... 1 walking
  double speed = 0.0;       ///< speed for the amplitudes [m/s]
};

/// Adds the motion of pelvis, trunk, head and arms while walking: the pelvis rotates forward with the landing leg (4
/// degrees), drops towards the swinging leg (3.5 degrees) and shifts over the stance foot (1.8 cm); the chest rotates
/// in the opposite direction, the head keeps its orientation; the arms swing opposite to the legs with bent elbows
/// (Murray 1967, figures 3, 4 and 6; the amplitudes there are for 1.5 m/s and are scaled with the step length here). It
/// also sets the posture of the hanging arms.
void add_gait(const GaitMoment& moment, const Style& style, Posture& posture);

/// Adds breathing (0.25 Hz), slow sway of the body and head motion, scaled by `amount`.
void add_idle(double time, const Style& style, double amount, Posture& posture);

/// Adds gestures: raises and moves upper arms and forearms, with pauses in which they return half way. Weight 0 ... 1.
void add_gesture(double time, const Style& style, double weight, Posture& posture);

/// Bends the trunk forward by an angle, distributed over pelvis, abdomen and chest; the head follows by half of it and
/// the arms keep hanging.
void add_bow(double angle, Posture& posture);

}  // namespace holdfast::simulation
