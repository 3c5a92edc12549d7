// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "holdfast/core/moving_object.hpp"

namespace holdfast::object_plugin {

/// What counts as moving.
struct MovingRule {
  double speed;        ///< at least [m/s]
  double moving_time;  ///< for which it must have lasted [s]
};

/// One sight of a thing.
struct ObjectSight {
  Eigen::Vector3d middle;     ///< of the visible surface, world [m]
  Eigen::Vector3d deviation;  ///< of the middle, for the part that shows changes: by axis of the camera [m]
  Eigen::Matrix3d R_world_camera;
};

/// A thing over time. Its velocity and angular velocity are random walks that alignment measures (Kalman filters); its
/// position follows the velocity and is drawn to the middle of what is seen of it, the less the less of it is seen; its
/// orientation follows the angular velocity.
///
/// A track begins as a candidate. It becomes an object, and gets an id, once it has moved faster than the rule says,
/// three standard deviations at least, for long enough.
class ObjectTrack {
 public:
  ObjectTrack(std::uint32_t name, double timestamp, const ObjectSight& sight);

  /// Moves on to a frame, `interval` seconds later. While it is not seen its velocity fades.
  void predict(double interval);
  /// Seen in the frame that was predicted, at `timestamp`.
  void see(double timestamp, const ObjectSight& sight);
  /// A motion over some seconds, in the world.
  struct Motion {
    Eigen::Vector3d displacement;         ///< [m]
    Eigen::Vector3d turned;               ///< rotation vector [rad]
    Eigen::Matrix3d covariance;           ///< of the displacement, as far as frames share it [m^2]
    Eigen::Matrix3d rotation_covariance;  ///< the same of the rotation [rad^2]
    double pose_noise, turning_noise;     ///< of the camera's own motion, new in every frame [m, rad]
    double interval;                      ///< [s]
    double repeats;                       ///< how many frames share most of the interval, and so its errors
  };
  void measure_motion(const Motion& motion);
  /// Extent of what is seen: box in the object frame.
  void measure_box(const Eigen::AlignedBox3f& box);
  /// Labels of the blocks that it shows: how many of each; `all` is their sum.
  void count_labels(const std::vector<int>& counts);
  /// Decides whether it moves; gives it the next id, and counts that up, when it becomes an object.
  void judge(const MovingRule& rule, double interval, std::uint32_t& next_id);
  /// The map was corrected.
  void transform(const Eigen::Isometry3d& T_new_old);

  std::uint32_t name() const { return name_; }  ///< from 1, candidates included
  bool is_object() const { return object_.id != 0; }
  bool moving() const { return object_.moving; }
  double resting_for() const { return resting_for_; }  ///< [s], 0 while it moves
  double last_seen() const { return object_.last_seen; }
  const Eigen::Vector3d& velocity() const { return object_.velocity; }
  const Eigen::Vector3d& angular_velocity() const { return object_.angular_velocity; }
  Eigen::Vector3d position() const { return object_.T_world_object.translation(); }
  const Eigen::AlignedBox3f& box() const { return object_.box; }
  /// Index of the class that most of its labels name, -1 when none does.
  int label() const;
  const MovingObject& object() const { return object_; }

 private:
  std::uint32_t name_;
  MovingObject object_;
  Eigen::Matrix3d velocity_covariance_, angular_covariance_;
  Eigen::Vector3d travelled_ = Eigen::Vector3d::Zero();  // since it began to move
  double moving_for_ = 0.0, resting_for_ = 0.0;          // [s]
  bool seen_ = true;                                     // in the frame predicted last
  std::vector<float> labels_;
};

}  // namespace holdfast::object_plugin
