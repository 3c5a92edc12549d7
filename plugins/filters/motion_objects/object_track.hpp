// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "holdfast/core/moving_object.hpp"

namespace holdfast::motion_objects_plugin {

/// Criterion for moving objects.
struct MovingRule {
  double speed;        ///< minimum speed [m/s]
  double moving_time;  ///< minimum duration of the motion [s]
};

/// One observation of an object.
struct ObjectObservation {
  Eigen::Vector3d centroid;  ///< of the visible surface, world [m]
  Eigen::Vector3d
      deviation;  ///< standard deviation of the centroid due to changes of the visible part, camera axes [m]
  Eigen::Matrix3d R_world_camera;
};

/// The track of an object over time. Velocity and angular velocity are random walks that are measured by alignment
/// (Kalman filters). The position is predicted with the velocity and corrected towards the centroid of the visible
/// surface, with a smaller gain if less of the object is visible. The orientation is predicted with the angular
/// velocity.
///
/// A track begins as a candidate. It becomes an object and gets an id when its speed exceeds that of the rule and three
/// standard deviations for long enough.
class ObjectTrack {
 public:
  ObjectTrack(std::uint32_t track_id, double timestamp, const ObjectObservation& observation);

  /// Predicts the state `interval` seconds later. The velocity of an occluded track decays.
  void predict(double interval);
  /// Corrects the predicted state with an observation at `timestamp`.
  void update(double timestamp, const ObjectObservation& observation);
  /// A measured motion over an interval, world frame.
  struct Motion {
    Eigen::Vector3d displacement;         ///< [m]
    Eigen::Vector3d turned;               ///< rotation vector [rad]
    Eigen::Matrix3d covariance;           ///< of the displacement, the part that consecutive frames share [m^2]
    Eigen::Matrix3d rotation_covariance;  ///< the same of the rotation [rad^2]
    double pose_noise, turning_noise;     ///< of the camera pose, independent in every frame [m, rad]
    double interval;                      ///< [s]
    double repeats;                       ///< number of frames that share most of the interval, and thus its errors
  };
  void measure_motion(const Motion& motion);
  /// Updates the extent with the bounding box of the visible surface, object frame.
  void measure_box(const Eigen::AlignedBox3f& box);
  /// Adds the number of visible blocks with each label.
  void count_labels(const std::vector<int>& counts);
  /// Decides whether the track moves. A track that becomes an object gets `next_id`, which is then incremented.
  void classify(const MovingRule& rule, double interval, std::uint32_t& next_id);
  /// Transforms the track after a correction of the map.
  void transform(const Eigen::Isometry3d& T_new_old);

  std::uint32_t track_id() const { return track_id_; }  ///< from 1, candidates included
  bool is_object() const { return object_.id != 0; }
  bool moving() const { return object_.moving; }
  double resting_for() const { return resting_for_; }  ///< [s], 0 while it moves
  double last_seen() const { return object_.last_seen; }
  const Eigen::Vector3d& velocity() const { return object_.velocity; }
  const Eigen::Vector3d& angular_velocity() const { return object_.angular_velocity; }
  Eigen::Vector3d position() const { return object_.T_world_object.translation(); }
  const Eigen::AlignedBox3f& box() const { return object_.box; }
  /// Id of its instance in the masks, 0 if it has none.
  std::uint16_t instance() const { return object_.instance; }
  void set_instance(std::uint16_t instance) { object_.instance = instance; }
  /// Index of the most frequent class of its labels, -1 without labels.
  int label() const;
  const MovingObject& object() const { return object_; }

 private:
  std::uint32_t track_id_;
  MovingObject object_;
  Eigen::Matrix3d velocity_covariance_, angular_covariance_;
  Eigen::Vector3d travelled_ = Eigen::Vector3d::Zero();  // since the start of the motion
  double moving_for_ = 0.0, resting_for_ = 0.0;          // [s]
  bool seen_ = true;                                     // in the last predicted frame
  std::vector<float> labels_;
};

}  // namespace holdfast::motion_objects_plugin
