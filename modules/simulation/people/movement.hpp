// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "curves.hpp"
#include "holdfast/simulation/footsteps.hpp"
#include "holdfast/simulation/gait.hpp"
#include "holdfast/simulation/limbs.hpp"
#include "holdfast/simulation/route.hpp"
#include "holdfast/simulation/skeleton.hpp"

namespace holdfast::simulation {

/// Where somebody stands, and in which step.
struct Stance {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double heading = 0.0;
  GaitMoment gait;
};

/// Where hands take hold of a thing, in the thing's frame: place, and the directions of palm and fingers; by Side.
struct Grips {
  std::array<Eigen::Vector3d, 2> points, palms, fingers;
};

class Movement;

/// Where a thing is that somebody moves: at rest, and in pieces of time as the person's body says.
class ThingTrack {
 public:
  using Motion = std::function<Eigen::Isometry3d(const Movement& movement, double time)>;

  ThingTrack() : ThingTrack(Eigen::Isometry3d::Identity()) {}
  explicit ThingTrack(const Eigen::Isometry3d& rest) : rest_(rest) {}
  /// Moves in an interval after all before, and rests afterwards.
  void move(double from, double to, Motion motion, const Eigen::Isometry3d& rest_after);
  Eigen::Isometry3d pose(const Movement& movement, double time) const;
  /// Where it rests in the end.
  const Eigen::Isometry3d& rest() const { return pieces_.empty() ? rest_ : pieces_.back().rest_after; }

 private:
  struct Piece {
    double from, to;
    Motion motion;
    Eigen::Isometry3d rest_after;
  };
  Eigen::Isometry3d rest_;
  std::vector<Piece> pieces_;
};

/// A person's whole movement as a function of time. It is put together from the start on (wait, turn, walk and what is
/// added to them), closed by `finish`, and then only asked.
class Movement {
 public:
  Movement(const Skeleton& skeleton, const Style& style, const Eigen::Vector2d& at, double heading);

  // Putting together. Each piece starts where the last one ended.
  double end() const { return end_; }
  const Stance& last() const { return last_; }
  void wait(double duration);
  /// Turns on the spot, the shorter way, with small steps.
  void turn(double heading);
  /// Walks the first `length` metres of a route; `pose` tells position and heading by the distance.
  void walk(const Travel& travel, double length, double speed, const std::function<Stance(double distance)>& pose);
  /// Moves the body without steps for a time, by an offset that comes and goes smoothly (sitting down).
  void shift(const Window& window, const Eigen::Vector2d& offset);

  struct Seat {
    Window window;
    double drop;   ///< of the pelvis [m]
    double lean;   ///< of the trunk while seated [rad]
    double table;  ///< height on which the hands lie; 0 = on the thighs [m]
  };
  /// Bowing and bending the knees, fully or in part.
  struct Bend {
    Window window;
    double bow, drop, back;  ///< [rad], [m], [m]
  };
  struct Hold {
    Window window;
    std::string thing;
    Grips grips;
  };
  std::vector<Seat> seats;
  std::vector<Bend> bends;
  std::vector<Hold> holds;
  std::vector<Window> gestures;
  std::map<std::string, ThingTrack> things;

  /// Finds the pelvis' height over time: as high as the legs reach, smoothed over 0.16 s.
  void finish(double duration);

  // Asking.
  const Skeleton& skeleton() const { return skeleton_; }
  Stance stance(double time) const;
  Eigen::Isometry3d root(double time) const;
  double pelvis_height(double time) const;
  Posture posture(double time) const;
  FootPose foot(Side side, double time) const { return feet_[side == Side::right].pose(time); }
  Eigen::Isometry3d thing(const std::string& name, double time) const { return things.at(name).pose(*this, time); }

  /// Standing upright, at the hips [m].
  double standing_height() const { return skeleton_.joint(Bone::pelvis).z() - 0.003; }
  /// Where the shoulder comes in the person's frame when bent like this.
  Eigen::Vector3d bent_shoulder(Side side, double bow, double drop, double back) const;

 private:
  struct Piece {
    double from, to;
    std::function<Stance(double time)> stance;
  };
  void add(double duration, std::function<Stance(double time)> stance);
  void step(Side side, FootTrack::Step step, double width);
  /// Pelvis (without its height) and trunk.
  Posture trunk(double time, const Stance& stance) const;

  Skeleton skeleton_;
  Style style_;
  Stance last_;
  double end_ = 0.0;
  std::vector<Piece> pieces_;
  std::array<FootTrack, 2> feet_;
  Side next_foot_;
  std::vector<double> heights_;
};

}  // namespace holdfast::simulation
