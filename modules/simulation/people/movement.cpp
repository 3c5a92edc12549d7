// SPDX-License-Identifier: BSD-3-Clause
#include "movement.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace holdfast::simulation {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {
constexpr double height_step = 0.02;  // of the table of the pelvis' heights [s]
constexpr int smoothed = 4;           // to both sides [height_step]
constexpr double most_stretch = 0.9965;

Isometry3d placed(const Stance& stance) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(stance.heading, Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() << stance.position, 0.0;
  return pose;
}

Isometry3d pelvis_pose(const Posture& posture) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = posture.rotations[index(Bone::pelvis)].toRotationMatrix();
  pose.translation() = posture.pelvis;
  return pose;
}

/// The first of windows in order of time that has not gone at a time.
template <class Item, class WindowOf>
const Item* current(const std::vector<Item>& items, double time, WindowOf&& window) {
  const auto found =
      std::partition_point(items.begin(), items.end(), [&](const Item& item) { return window(item).gone <= time; });
  return found != items.end() && window(*found).from < time ? &*found : nullptr;
}
const auto own_window = [](const auto& item) -> const Window& { return item.window; };
const auto itself = [](const Window& window) -> const Window& { return window; };

std::vector<double> averaged(const std::vector<double>& values, int half) {
  const int count = static_cast<int>(values.size());
  std::vector<double> result(values.size());
  for (int i = 0; i < count; ++i) {
    double sum = 0.0;
    for (int j = i - half; j <= i + half; ++j) sum += values[std::clamp(j, 0, count - 1)];
    result[i] = sum / (2 * half + 1);
  }
  return result;
}
}  // namespace

void ThingTrack::move(double from, double to, Motion motion, const Isometry3d& rest_after) {
  pieces_.push_back({from, to, std::move(motion), rest_after});
}

Isometry3d ThingTrack::pose(const Movement& movement, double time) const {
  const auto after =
      std::partition_point(pieces_.begin(), pieces_.end(), [&](const Piece& piece) { return piece.from <= time; });
  if (after == pieces_.begin()) return rest_;
  const Piece& piece = *(after - 1);
  return time < piece.to ? piece.motion(movement, time) : piece.rest_after;
}

Stance Movement::stance(double time) const {
  const auto after =
      std::partition_point(pieces_.begin(), pieces_.end(), [&](const Piece& piece) { return piece.from <= time; });
  if (after == pieces_.begin()) return pieces_.empty() ? last_ : pieces_.front().stance(pieces_.front().from);
  const Piece& piece = *(after - 1);
  return piece.stance(std::min(time, piece.to));
}

Isometry3d Movement::root(double time) const { return placed(stance(time)); }

Posture Movement::trunk(double time, const Stance& stance) const {
  Posture posture;
  add_gait(stance.gait, style_, posture);
  add_idle(time, style_, 1.0 - 0.75 * stance.gait.amplitude, posture);
  if (const Seat* seat = current(seats, time, own_window)) {
    const double down = seat->window.raw(time);
    add_bow(0.75 * bump(0.9 * down + 0.1 * down * down) + seat->lean * ease(down), posture);
  }
  if (const Bend* bend = current(bends, time, own_window)) {
    const double share = bend->window.weight(time);
    add_bow(share * bend->bow, posture);
    posture.pelvis.y() += share * bend->back;
  }
  // The head turns first into a bend.
  const double ahead = 0.6 * std::tanh(1.2 * (this->stance(time + 0.4).heading - stance.heading));
  for (const Bone bone : {Bone::neck, Bone::head}) {
    Quaterniond& rotation = posture.rotations[index(bone)];
    rotation = (rotation * Eigen::AngleAxisd(0.5 * ahead, Vector3d::UnitZ())).normalized();
  }
  return posture;
}

Vector3d Movement::bent_shoulder(Side side, double bow, double drop, double back) const {
  Posture posture;
  add_bow(bow, posture);
  posture.pelvis = Vector3d(0, back, standing_height() - drop);
  return skeleton_.place(posture)[index(Bone::chest)] * skeleton_.joint(arm(side).upper);
}

void Movement::finish(double duration) {
  const int count = static_cast<int>(std::ceil(std::max(duration, end_) / height_step)) + 2;
  std::vector<double> reachable(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double time = i * height_step;
    const Stance now = stance(time);
    const Posture posture = trunk(time, now);
    const Isometry3d T_person_world = placed(now).inverse(), T_person_pelvis = pelvis_pose(posture);
    double height = standing_height() - 0.004 * now.gait.amplitude;
    if (const Seat* seat = current(seats, time, own_window)) height -= seat->drop * seat->window.weight(time);
    if (const Bend* bend = current(bends, time, own_window)) height -= bend->drop * bend->window.weight(time);
    for (const Side side : {Side::left, Side::right}) {
      const Vector3d hip = T_person_pelvis * skeleton_.joint(leg(side).upper);  // above the pelvis' unknown height
      const Vector3d ankle = T_person_world * foot(side, time).ankle;
      const double reach = most_stretch * (skeleton_.length(leg(side).upper) + skeleton_.length(leg(side).lower));
      const double apart = std::min((hip - ankle).head<2>().norm(), 0.95 * reach);
      height = std::min(height, ankle.z() + std::sqrt(reach * reach - apart * apart) - hip.z());
    }
    reachable[i] = height;
  }
  // The lowest of a neighbourhood, averaged over the same neighbourhood, is smooth and never above what was reachable.
  std::vector<double> lowest(reachable.size());
  for (int i = 0; i < count; ++i)
    lowest[i] = *std::min_element(reachable.begin() + std::max(0, i - smoothed),
                                  reachable.begin() + std::min(count, i + smoothed + 1));
  heights_ = averaged(averaged(lowest, smoothed / 2), smoothed / 2);
}

double Movement::pelvis_height(double time) const {
  const int count = static_cast<int>(heights_.size());
  const double place = std::clamp(time / height_step, 0.0, count - 1.001);
  const int i = static_cast<int>(place);
  const double x = place - i;
  const auto at = [&](int j) { return heights_[std::clamp(j, 0, count - 1)]; };
  // Cubic B-spline: smooth to the second derivative, and within what its four values allow.
  const double y = 1.0 - x;
  return (y * y * y * at(i - 1) + (4.0 - 6.0 * x * x + 3.0 * x * x * x) * at(i) +
          (4.0 - 6.0 * y * y + 3.0 * y * y * y) * at(i + 1) + x * x * x * at(i + 2)) /
         6.0;
}

Posture Movement::posture(double time) const {
  const Stance now = stance(time);
  const Isometry3d T_person_world = placed(now).inverse();
  Posture posture = trunk(time, now);
  posture.pelvis.z() = pelvis_height(time);
  const Isometry3d T_person_pelvis = pelvis_pose(posture);
  for (const Side side : {Side::left, Side::right}) {
    const FootPose placed_foot = foot(side, time);
    place_foot(skeleton_, T_person_pelvis, side, T_person_world * placed_foot.ankle,
               Quaterniond(T_person_world.linear()) * placed_foot.rotation(), posture);
  }
  const BonePoses poses = skeleton_.place(posture);
  const Isometry3d& chest = poses[index(Bone::chest)];
  const Seat* seat = current(seats, time, own_window);
  const Window* gesture = current(gestures, time, itself);
  const Hold* hold = current(holds, time, own_window);
  for (const Side side : {Side::left, Side::right}) {
    if (seat == nullptr) break;
    // Palms on the thighs or on the table, fingers forward and a little inwards.
    const Isometry3d& thigh = poses[index(leg(side).upper)];
    Vector3d point =
        thigh * Vector3d(0, -0.042 * skeleton_.physique().height, -0.68 * skeleton_.length(leg(side).upper));
    point.x() = sign(side) * std::max(0.12, std::abs(point.x()));
    Vector3d palm = thigh.linear().col(1);
    Vector3d fingers(-0.2 * sign(side), -1.0, -0.2);
    if (seat->table > 0) {
      point = Vector3d(0.15 * sign(side), -0.26 * skeleton_.physique().height, seat->table);
      palm = -Vector3d::UnitZ();
      fingers.z() = 0.0;
    }
    reach(skeleton_, chest, side, hand_on(skeleton_, side, point, palm, fingers),
          ease((seat->window.raw(time) - 0.2) / 0.8), posture);
  }
  if (gesture != nullptr) add_gesture(time, style_, gesture->weight(time), posture);
  if (hold != nullptr) {
    const Isometry3d T_person_thing = T_person_world * thing(hold->thing, time);
    for (const Side side : {Side::left, Side::right}) {
      const auto i = static_cast<std::size_t>(side);
      reach(skeleton_, chest, side,
            hand_on(skeleton_, side, T_person_thing * hold->grips.points[i],
                    T_person_thing.linear() * hold->grips.palms[i], T_person_thing.linear() * hold->grips.fingers[i]),
            hold->window.weight(time), posture);
    }
  }
  return posture;
}

}  // namespace holdfast::simulation
