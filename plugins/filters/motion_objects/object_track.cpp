// SPDX-License-Identifier: BSD-3-Clause
#include "object_track.hpp"

#include <algorithm>
#include <cmath>

#include "holdfast/geometry/se3.hpp"

namespace holdfast::object_plugin {

namespace {

constexpr double unknown_speed = 0.5;      // standard deviation of a velocity before it is measured [m/s]
constexpr double restlessness = 0.5;       // growth of a velocity's variance [(m/s)^2/s]
constexpr double fading_time = 0.5;        // in which the velocity of what is hidden falls to 1/e [s]
constexpr double turning_gain = 0.1;       // of the angular velocity, by measurement
constexpr double middle_gain = 0.15;       // of the position, by sight, when all of the thing shows
constexpr double middle_deviation = 0.02;  // of a middle then [m]

}  // namespace

ObjectTrack::ObjectTrack(std::uint32_t name, double timestamp, const ObjectSight& sight)
    : name_(name), velocity_covariance_(unknown_speed * unknown_speed * Eigen::Matrix3d::Identity()) {
  object_.T_world_object.translation() = sight.middle;
  object_.first_seen = object_.last_seen = timestamp;
}

void ObjectTrack::predict(double interval) {
  if (!seen_) object_.velocity *= std::exp(-interval / fading_time), object_.angular_velocity.setZero();
  object_.T_world_object.translation() += interval * object_.velocity;
  const Eigen::Matrix3d turn =
      geometry::exp_so3(Eigen::Vector3d(interval * object_.angular_velocity)).toRotationMatrix();
  object_.T_world_object.linear() = turn * object_.T_world_object.linear();
  object_.T_world_object = geometry::orthonormalised(object_.T_world_object);
  velocity_covariance_ += restlessness * interval * Eigen::Matrix3d::Identity();
  seen_ = false;
}

void ObjectTrack::see(double timestamp, const ObjectSight& sight) {
  const Eigen::Vector3d away = sight.R_world_camera.transpose() * (sight.middle - position());
  Eigen::Vector3d step;
  for (int axis = 0; axis < 3; ++axis)
    step[axis] = away[axis] * middle_gain * std::min(1.0, middle_deviation / sight.deviation[axis]);
  object_.T_world_object.translation() += sight.R_world_camera * step;
  object_.last_seen = timestamp;
  seen_ = true;
}

void ObjectTrack::measure_motion(const Eigen::Vector3d& displacement, const Eigen::Matrix3d& covariance,
                                 const Eigen::Vector3d& turned, double interval, double repeats) {
  const Eigen::Matrix3d noise = covariance * (repeats / (interval * interval));
  const Eigen::Matrix3d gain = velocity_covariance_ * (velocity_covariance_ + noise).inverse();
  object_.velocity += gain * (displacement / interval - object_.velocity);
  velocity_covariance_ -= gain * velocity_covariance_;
  velocity_covariance_ = 0.5 * (velocity_covariance_ + velocity_covariance_.transpose().eval());
  object_.angular_velocity += turning_gain * (turned / interval - object_.angular_velocity);
}

void ObjectTrack::measure_box(const Eigen::AlignedBox3f& box) {
  if (object_.box.isEmpty()) {
    object_.box = box;
    return;
  }
  // What comes into view belongs to the thing; what leaves it is rather hidden than gone.
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

void ObjectTrack::judge(const MovingRule& rule, double interval, std::uint32_t& next_id) {
  const double speed = object_.speed();
  const Eigen::Vector3d direction = speed > 0.0 ? Eigen::Vector3d(object_.velocity / speed) : Eigen::Vector3d::UnitX();
  const double deviation = std::sqrt(std::max(0.0, direction.dot(velocity_covariance_ * direction)));
  object_.speed_deviation = static_cast<float>(deviation);
  constexpr double significant = 3.0, slower = 0.5, least_way = 0.05;
  if (seen_) {
    if (speed > rule.speed && speed > significant * deviation) {
      moving_for_ += interval;
      travelled_ += interval * object_.velocity;
    } else if (speed < slower * rule.speed || speed < deviation) {
      moving_for_ = 0.0;
      travelled_.setZero();
    }
  }
  if (moving_for_ >= rule.moving_time && travelled_.norm() >= least_way) {
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
  travelled_ = T_new_old.linear() * travelled_;
}

}  // namespace holdfast::object_plugin
