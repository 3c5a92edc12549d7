// SPDX-License-Identifier: BSD-3-Clause
#include "object_track.hpp"

#include <algorithm>
#include <cmath>

#include "holdfast/geometry/se3.hpp"

namespace holdfast::motion_objects_plugin {

namespace {

constexpr double unknown_speed = 0.5;        // standard deviation of a velocity before it is measured [m/s]
constexpr double restlessness = 0.5;         // growth of a velocity's variance [(m/s)^2/s]
constexpr double forgetting_time = 5.0;      // in which an unmeasured velocity decays to 1/e [s]
constexpr double fading_time = 0.5;          // in which the velocity of an occluded track decays to 1/e [s]
constexpr double unknown_turning = 0.3;      // standard deviation of an angular velocity before it is measured [rad/s]
constexpr double unsteadiness = 0.2;         // growth of its variance [(rad/s)^2/s]
constexpr double centroid_gain = 0.15;       // correction of the position per observation of the whole object
constexpr double centroid_deviation = 0.01;  // of its centroid [m]

/// Kalman update of a state that is measured directly.
void kalman_update(const Eigen::Vector3d& measured, const Eigen::Matrix3d& noise, Eigen::Vector3d& state,
                   Eigen::Matrix3d& covariance) {
  const Eigen::Matrix3d gain = covariance * (covariance + noise).inverse();
  state += gain * (measured - state);
  covariance -= (gain * covariance).eval();
  covariance = (0.5 * (covariance + covariance.transpose())).eval();
}

}  // namespace

ObjectTrack::ObjectTrack(std::uint32_t track_id, double timestamp, const ObjectObservation& observation)
    : track_id_(track_id),
      velocity_covariance_(unknown_speed * unknown_speed * Eigen::Matrix3d::Identity()),
      angular_covariance_(unknown_turning * unknown_turning * Eigen::Matrix3d::Identity()) {
  object_.T_world_object.translation() = observation.centroid;
  object_.first_seen = object_.last_seen = timestamp;
}

void ObjectTrack::predict(double interval) {
  if (!seen_) object_.angular_velocity.setZero();
  const double kept = std::exp(-interval / (seen_ ? forgetting_time : fading_time));
  object_.velocity *= kept;
  object_.T_world_object.translation() += interval * object_.velocity;
  const Eigen::Matrix3d turn =
      geometry::exp_so3(Eigen::Vector3d(interval * object_.angular_velocity)).toRotationMatrix();
  object_.T_world_object.linear() = turn * object_.T_world_object.linear();
  object_.T_world_object = geometry::orthonormalised(object_.T_world_object);
  velocity_covariance_ *= kept * kept;
  velocity_covariance_ += restlessness * interval * Eigen::Matrix3d::Identity();
  angular_covariance_ *= kept * kept;
  angular_covariance_ += unsteadiness * interval * Eigen::Matrix3d::Identity();
  seen_ = false;
}

void ObjectTrack::update(double timestamp, const ObjectObservation& observation) {
  const Eigen::Vector3d away = observation.R_world_camera.transpose() * (observation.centroid - position());
  Eigen::Vector3d step;
  for (int axis = 0; axis < 3; ++axis)
    step[axis] = away[axis] * centroid_gain * std::min(1.0, centroid_deviation / observation.deviation[axis]);
  object_.T_world_object.translation() += observation.R_world_camera * step;
  object_.last_seen = timestamp;
  seen_ = true;
}

void ObjectTrack::measure_motion(const Motion& motion) {
  const double per_second = 1.0 / motion.interval;
  const auto noise = [&](const Eigen::Matrix3d& covariance, double own) -> Eigen::Matrix3d {
    return (motion.repeats * covariance + own * own * Eigen::Matrix3d::Identity()) * (per_second * per_second);
  };
  kalman_update(per_second * motion.displacement, noise(motion.covariance, motion.pose_noise), object_.velocity,
                velocity_covariance_);
  kalman_update(per_second * motion.turned, noise(motion.rotation_covariance, motion.turning_noise),
                object_.angular_velocity, angular_covariance_);
}

void ObjectTrack::measure_box(const Eigen::AlignedBox3f& box) {
  if (object_.box.isEmpty()) {
    object_.box = box;
    return;
  }
  // A newly visible part belongs to the object; a part that disappears is probably occluded.
  constexpr float outward = 0.3F, inward = 0.03F;
  for (int axis = 0; axis < 3; ++axis) {
    float& low = object_.box.min()[axis];
    float& high = object_.box.max()[axis];
    low += (box.min()[axis] < low ? outward : inward) * (box.min()[axis] - low);
    high += (box.max()[axis] > high ? outward : inward) * (box.max()[axis] - high);
  }
}

void ObjectTrack::count_labels(const std::vector<int>& counts) {
  constexpr float kept = 0.95F;
  labels_.resize(std::max(labels_.size(), counts.size()), 0.0F);
  for (float& label : labels_) label *= kept;
  for (std::size_t i = 0; i < counts.size(); ++i) labels_[i] += static_cast<float>(counts[i]);
}

int ObjectTrack::label() const {
  float all = 0.0F;
  for (const float label : labels_) all += label;
  for (std::size_t i = 0; i < labels_.size(); ++i)
    if (labels_[i] > 0.5F * all) return static_cast<int>(i);
  return -1;
}

void ObjectTrack::classify(const MovingRule& rule, double interval, std::uint32_t& next_id) {
  const double speed = object_.speed();
  const Eigen::Vector3d direction = speed > 0.0 ? Eigen::Vector3d(object_.velocity / speed) : Eigen::Vector3d::UnitX();
  const double deviation = std::sqrt(std::max(0.0, direction.dot(velocity_covariance_ * direction)));
  object_.speed_deviation = static_cast<float>(deviation);
  constexpr double significant = 3.0, slower = 0.5, min_distance = 0.05;
  if (seen_) {
    if (speed > rule.speed && speed > significant * deviation) {
      moving_for_ += interval;
      travelled_ += interval * object_.velocity;
    } else if (speed < slower * rule.speed || speed < deviation) {
      moving_for_ = 0.0;
      travelled_.setZero();
    }
  }
  if (moving_for_ >= rule.moving_time && travelled_.norm() >= min_distance) {
    object_.moving = true;
    if (object_.id == 0) object_.id = next_id++;
  } else if (moving_for_ == 0.0) {
    object_.moving = false;
  }
  resting_for_ = object_.moving ? 0.0 : resting_for_ + interval;
}

void ObjectTrack::transform(const Eigen::Isometry3d& T_new_old) {
  object_.T_world_object = T_new_old * object_.T_world_object;
  object_.velocity = T_new_old.linear() * object_.velocity;
  object_.angular_velocity = T_new_old.linear() * object_.angular_velocity;
  velocity_covariance_ = T_new_old.linear() * velocity_covariance_ * T_new_old.linear().transpose();
  angular_covariance_ = T_new_old.linear() * angular_covariance_ * T_new_old.linear().transpose();
  travelled_ = T_new_old.linear() * travelled_;
}

}  // namespace holdfast::motion_objects_plugin
