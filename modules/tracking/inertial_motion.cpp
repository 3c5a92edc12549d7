// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/inertial_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "holdfast/core/imu_timeline.hpp"
#include "holdfast/interfaces/inertial_history.hpp"

namespace holdfast {

namespace {

/// With six degrees of freedom, 18 is exceeded by chance once in 160 frames; poses from images have heavier tails.
constexpr double largest_chi_square = 40.0;
constexpr int tolerated_later = 15, tolerated_at_start = 2, tolerated_refusals = 4;  // frames in a row
/// A prediction over more than this time [s] says as much as those of some frames.
constexpr double slow_interval = 0.2;
constexpr int weight_of_slow_frame = 3;
constexpr double most_lost_time = 10.0;  // [s]; then the velocity says nothing
/// Where the estimates of an earlier run are known. Biases differ each time that a sensor is switched on.
constexpr double unknown_velocity = 1.0;  // [m/s]
constexpr double gyroscope_repeatability = 0.003, accelerometer_repeatability = 0.03;
constexpr double gravity_repeatability = 0.003, mounting_repeatability = 0.001, time_repeatability = 0.001;
constexpr double largest_first_deviation = 0.02;  // of the first pose [m]
constexpr int most_known_trials = 3;

}  // namespace

InertialMotion::InertialMotion(const std::optional<ImuCalibration>& imu, bool scale_is_known)
    : imu_(imu), scale_is_known_(scale_is_known) {
  if (imu) starter_.emplace(*imu, scale_is_known);
}

void InertialMotion::begin_frame(const SensorFrame& frame) {
  if (!imu_) return;
  now_.reset();
  is_corrected_ = is_refused_ = false;
  rate_.reset();
  const std::optional<double> before = std::exchange(timestamp_, frame.timestamp);
  starter_->begin_frame(frame.timestamp);
  if (!before) return;
  weight_ = frame.timestamp - *before > slow_interval ? weight_of_slow_frame : 1;
  const std::vector<ImuSample> samples = covering(frame.imu, *before, frame.timestamp, *imu_);
  const ImuBias bias = last_ ? last_->state().bias : ImuBias();
  const auto motion = geometry::preintegrate(samples, *before, frame.timestamp, imu_->noise, bias);
  if (!motion || has_saturated(samples, *imu_)) {
    interrupt();
    return;
  }
  rate_ = rate_at(samples, frame.timestamp);
  mean_turn_rate_ = geometry::log_so3(motion->delta().rotation).norm() / motion->duration();
  if (last_) {
    now_ = last_;
    now_->predict(*motion, *rate_);
  } else {
    starter_->add(samples);
  }
}

Eigen::Isometry3d InertialMotion::body_pose(const Eigen::Isometry3d& T_camera_world) const {
  Eigen::Isometry3d T_world_camera = T_camera_world.inverse();
  T_world_camera.translation() *= scale_;
  return T_world_camera * imu_->T_body_camera.inverse();
}

Eigen::Isometry3d InertialMotion::camera_pose(const Eigen::Isometry3d& T_world_body) const {
  Eigen::Isometry3d T_world_camera = T_world_body * imu_->T_body_camera;
  T_world_camera.translation() /= scale_;
  return T_world_camera.inverse();
}

void InertialMotion::follow_map(const Eigen::Isometry3d& T_camera_world) {
  if (!last_ || !anchor_) return;
  Eigen::Isometry3d T_new_old = T_camera_world.inverse() * *anchor_;
  constexpr double rounding = 1e-9;
  if ((T_new_old.matrix() - Eigen::Matrix4d::Identity()).cwiseAbs().maxCoeff() < rounding) return;
  T_new_old.translation() *= scale_;
  last_->move(T_new_old);
  if (now_) now_->move(T_new_old);
  anchor_ = T_camera_world;
}

std::optional<Eigen::Isometry3d> InertialMotion::step() const {
  if (!is_reliable()) return std::nullopt;
  return camera_pose(now_->pose()) * camera_pose(last_->pose()).inverse();
}

std::optional<Eigen::Vector3d> InertialMotion::turn_rate() const {
  if (!is_reliable()) return std::nullopt;
  const Eigen::Matrix3d R_camera_body = imu_->T_body_camera.linear().transpose() * now_->mounting();
  return R_camera_body * now_->angular_velocity();
}

std::optional<InertialPrediction> InertialMotion::prediction() const {
  if (!is_reliable()) return std::nullopt;
  InertialPrediction result;
  result.T_camera_world = camera_pose(now_->pose());
  const Eigen::Matrix3d R_camera_body = imu_->T_body_camera.linear().transpose() * now_->mounting();
  const Eigen::Vector3d camera_in_body = now_->mounting().transpose() * imu_->T_body_camera.translation();
  Eigen::Matrix<double, 6, 6> to_camera = Eigen::Matrix<double, 6, 6>::Zero();
  to_camera.topLeftCorner<3, 3>() = result.T_camera_world.linear() / scale_;
  to_camera.topRightCorner<3, 3>() = -R_camera_body * geometry::hat(camera_in_body) / scale_;
  to_camera.bottomRightCorner<3, 3>() = R_camera_body;
  result.covariance = to_camera * now_->pose_covariance() * to_camera.transpose();
  result.position_deviation = std::sqrt(result.covariance.diagonal().head<3>().maxCoeff());
  result.rotation_deviation = std::sqrt(result.covariance.diagonal().tail<3>().maxCoeff());
  return result;
}

/// Of tracked poses: as the start found them to be, and larger where few matches determine one or the camera moves
/// fast.
InertialFilter::PoseCovariance InertialMotion::measurement_covariance(double deviation) const {
  constexpr double stamp_deviation = 0.002;  // of time stamps [s]; those of cameras without a trigger scatter
  const double speed = now_ ? now_->state().velocity.norm() : 0.0;
  const auto total = [](double a, double b, double c) { return a * a + b * b + c * c; };
  InertialFilter::PoseCovariance covariance = InertialFilter::PoseCovariance::Zero();
  covariance.diagonal().head<3>().setConstant(total(deviations_.position, scale_ * deviation, stamp_deviation * speed));
  covariance.diagonal().tail<3>().setConstant(total(deviations_.rotation, stamp_deviation * mean_turn_rate_, 0.0));
  return covariance;
}

bool InertialMotion::contradicts(const Eigen::Isometry3d& T_camera_world, double factor) const {
  return is_reliable() && now_->chi_square(body_pose(T_camera_world), measurement_covariance(0.0)) >
                              factor * factor * largest_chi_square;
}

void InertialMotion::count_refusal(const Eigen::Isometry3d& T_camera_world, double factor) {
  if (is_refused_ || !contradicts(T_camera_world, factor)) return;
  is_refused_ = true;
  if ((refusals_ += weight_) > tolerated_refusals) refute();
}

bool InertialMotion::correct(const Eigen::Isometry3d& T_camera_world, const Eigen::Matrix<double, 6, 6>& covariance,
                             bool is_relative) {
  if (!is_reliable()) return false;
  // From a left perturbation of T_camera_world to position in the world and rotation of the body.
  const Eigen::Matrix3d R_world_camera = T_camera_world.linear().transpose();
  const Eigen::Matrix3d R_body_camera = imu_->T_body_camera.linear();
  const Eigen::Vector3d body_in_camera = imu_->T_body_camera.inverse().translation();
  Eigen::Matrix<double, 6, 6> to_body = Eigen::Matrix<double, 6, 6>::Zero();
  to_body.topLeftCorner<3, 3>() = scale_ * R_world_camera;
  to_body.topRightCorner<3, 3>() = -R_world_camera * geometry::hat(body_in_camera);
  to_body.bottomRightCorner<3, 3>() = R_body_camera;
  // The few features may be wrong together: three times the deviation that they state.
  constexpr double inflation = 9.0;
  InertialFilter::PoseCovariance total =
      inflation * to_body * covariance * to_body.transpose() + measurement_covariance(0.0);
  if (is_relative) total += last_->pose_covariance();
  const Eigen::Isometry3d measured = body_pose(T_camera_world);
  if (!(now_->chi_square(measured, total) <= largest_chi_square)) return false;
  now_->correct(measured, total);
  is_corrected_ = true;
  return true;
}

void InertialMotion::found(const Eigen::Isometry3d& T_camera_world, double deviation, const PastPose& past_pose) {
  if (!imu_) return;
  found_time_ = *timestamp_;
  if (now_ && is_corrected_) {
    contradictions_ = refusals_ = 0;
    last_ = now_;
  } else if (now_) {
    learn(T_camera_world, deviation);
  } else if (known_ && rate_ && deviation * known_->scale <= largest_first_deviation) {
    begin_with_known(T_camera_world);
  } else if (const std::optional<FoundInertialStart> start = starter_->found(past_pose)) {
    begin_filter(*start);
  }
  anchor_ = T_camera_world;
}

void InertialMotion::learn(const Eigen::Isometry3d& T_camera_world, double deviation) {
  const Eigen::Isometry3d measured = body_pose(T_camera_world);
  const InertialFilter::PoseCovariance covariance = measurement_covariance(deviation);
  if (now_->chi_square(measured, covariance) <= largest_chi_square) {
    now_->correct(measured, covariance);
    confirmations_ = std::min(confirmations_ + weight_, required_confirmations);
    contradictions_ = refusals_ = 0;
  } else if (confirmations_ < required_confirmations ? ++contradictions_ > tolerated_at_start
                                                     : (contradictions_ += weight_) > tolerated_later) {
    refute();
    return;
  }
  last_ = now_;
}

void InertialMotion::keep_prediction(const Eigen::Isometry3d& T_camera_world) {
  last_ = now_;
  anchor_ = T_camera_world;
}

void InertialMotion::lost() {
  if (!imu_) return;
  if (now_ && *timestamp_ - found_time_ <= most_lost_time)
    last_ = now_;
  else if (last_)
    interrupt();
}

/// The state is lost, and what changes slowly is kept.
void InertialMotion::interrupt() {
  const std::optional<MapInertia> known = estimates();
  reset();
  known_ = known;
}

/// The state was wrong. If no image confirmed it, perhaps only the pose was that it began with.
void InertialMotion::refute() {
  const bool tries_again = confirmations_ < required_confirmations && known_trials_ < most_known_trials;
  const std::optional<MapInertia> known = tries_again ? known_ : std::nullopt;
  const int trials = known_trials_;
  reset();
  known_ = known;
  if (known_) known_trials_ = trials;
}

std::optional<MapInertia> InertialMotion::estimates() const {
  if (!last_ || confirmations_ < required_confirmations) return known_;
  MapInertia result;
  result.gravity = last_->gravity();
  result.scale = scale_;
  result.bias = last_->state().bias;
  result.mounting = last_->mounting();
  result.time_offset = last_->time_offset();
  const InertialFilter::Deviations deviations = last_->deviations();
  result.gravity_deviation = deviations.direction;
  result.gyroscope_deviation = deviations.gyroscope;
  result.accelerometer_deviation = deviations.accelerometer;
  result.mounting_deviation = deviations.mounting;
  result.time_offset_deviation = deviations.time_offset;
  result.position_deviation = deviations_.position;
  result.rotation_deviation = deviations_.rotation;
  result.T_body_camera = imu_->T_body_camera;
  result.calibrated_time_offset = imu_->time_offset;
  return result;
}

/// Biases and corrections of the calibration are used for the same calibration only, gravity and scale always.
void InertialMotion::begin_with_known(const Eigen::Isometry3d& T_camera_world) {
  const MapInertia& known = *known_;
  ++known_trials_;
  scale_ = scale_is_known_ ? 1.0 : known.scale;
  deviations_ = {known.position_deviation, known.rotation_deviation};
  const geometry::InertialStartOptions priors;
  InertialFilter::Deviations deviations{known.position_deviation,
                                        known.rotation_deviation,
                                        unknown_velocity,
                                        priors.gyroscope_bias_deviation,
                                        priors.accelerometer_bias_deviation,
                                        std::hypot(known.gravity_deviation, gravity_repeatability),
                                        nominal_mounting_deviation,
                                        nominal_time_offset_deviation};
  geometry::InertialState state;
  state.T_world_body = body_pose(T_camera_world);
  const bool is_same = is_calibrated_as(known, *imu_);
  if (is_same) {
    state.bias = known.bias;
    const Eigen::Vector3d turn = known.time_offset * (*rate_ - known.bias.gyroscope);
    state.T_world_body.linear() =
        state.T_world_body.linear() * known.mounting * geometry::exp_so3(-turn).toRotationMatrix();
    deviations.gyroscope = std::hypot(known.gyroscope_deviation, gyroscope_repeatability);
    deviations.accelerometer = std::hypot(known.accelerometer_deviation, accelerometer_repeatability);
    deviations.mounting = std::hypot(known.mounting_deviation, mounting_repeatability);
    deviations.time_offset = std::hypot(known.time_offset_deviation, time_repeatability);
  }
  last_.emplace(state, known.gravity, deviations);
  if (is_same) last_->calibrate(known.mounting, known.time_offset);
  confirmations_ = contradictions_ = refusals_ = 0;
  starter_->clear();
}

void InertialMotion::reset() {
  last_.reset();
  now_.reset();
  anchor_.reset();
  if (starter_) starter_->clear();
  known_.reset();
  confirmations_ = contradictions_ = refusals_ = known_trials_ = 0;
  scale_ = 1.0;
}

/// The start gives the values. Their joint covariance is that of a filter that passes the same poses once more, from
/// wide priors.
void InertialMotion::begin_filter(const FoundInertialStart& found) {
  const geometry::InertialStart& start = found.start;
  const geometry::InertialStartOptions priors;
  scale_ = start.scale;
  deviations_ = found.deviations;
  geometry::InertialState state;
  state.T_world_body = body_pose(found.poses.front().T_world_camera.inverse());
  state.velocity = start.velocities.front();
  state.bias = start.bias;
  state.T_world_body.translation() -= start.time_offset * state.velocity;
  const Eigen::Vector3d turn = start.time_offset * (found.rates.front() - start.bias.gyroscope);
  state.T_world_body.linear() =
      state.T_world_body.linear() * start.mounting * geometry::exp_so3(-turn).toRotationMatrix();
  constexpr double velocity_prior = 0.2, direction_prior = 0.1;  // [m/s], [rad]
  InertialFilter filter(state, start.gravity,
                        {deviations_.position, deviations_.rotation, velocity_prior, priors.gyroscope_bias_deviation,
                         priors.accelerometer_bias_deviation, direction_prior, nominal_mounting_deviation,
                         nominal_time_offset_deviation});
  filter.calibrate(start.mounting, start.time_offset);
  for (std::size_t i = 0; i < found.motions.size(); ++i) {
    filter.predict(found.motions[i], found.rates[i + 1]);
    filter.correct(body_pose(found.poses[i + 1].T_world_camera.inverse()), measurement_covariance(0.0));
  }
  last_ = filter;
  confirmations_ = contradictions_ = refusals_ = 0;
  starter_->clear();
}

}  // namespace holdfast
