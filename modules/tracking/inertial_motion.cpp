// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/inertial_motion.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

#include "holdfast/core/imu_timeline.hpp"
#include "holdfast/geometry/inertial_start.hpp"
#include "holdfast/interfaces/inertial_history.hpp"

namespace holdfast {

namespace {

/// Measurements of the start [s].
constexpr double start_time = 2.0, start_time_of_one_camera = 5.0;
constexpr double pose_spacing = 0.1, pose_spacing_of_one_camera = 0.2;
constexpr double largest_pose_gap = 1.0;
constexpr std::size_t fewest_poses = 10;
/// The same of a slow camera, which takes fewer frames than that in this time.
constexpr double longest_start_time = 15.0, largest_pose_gap_of_slow_camera = 5.0;
constexpr std::size_t fewest_poses_of_slow_camera = 6;
/// A change of the gyroscope's bias that turns the motion between two poses by more than this [rad] is integrated anew.
constexpr double largest_linear_turn = 0.02;
constexpr int most_integrations = 3;
constexpr double start_interval = 0.25;  // between two attempts
/// With six degrees of freedom, 18 is exceeded by chance once in 160 frames; poses from images have heavier tails.
constexpr double largest_chi_square = 40.0;
constexpr int tolerated_later = 15, tolerated_at_start = 2, tolerated_refusals = 4;  // frames in a row
/// A prediction over more than this time [s] says as much as those of some frames.
constexpr double slow_interval = 0.2;
constexpr int weight_of_slow_frame = 3;
constexpr double most_lost_time = 10.0;  // [s]; then the velocity says nothing
/// Of calibrations: rotation [rad], time offset [s].
constexpr double mounting_deviation = 0.015, time_offset_deviation = 0.005;
/// Where the estimates of an earlier run are known. Biases differ each time that a sensor is switched on.
constexpr double unknown_velocity = 1.0;  // [m/s]
constexpr double gyroscope_repeatability = 0.003, accelerometer_repeatability = 0.03;
constexpr double gravity_repeatability = 0.003, mounting_repeatability = 0.001, time_repeatability = 0.001;
constexpr double largest_first_deviation = 0.02;  // of the first pose [m]
constexpr int most_known_trials = 3;

/// The angular velocity at a time that the samples cover, or else the nearest one.
Eigen::Vector3d rate_at(const std::vector<ImuSample>& samples, double time) {
  const auto next = std::find_if(samples.begin(), samples.end(),
                                 [time](const ImuSample& sample) { return sample.timestamp >= time; });
  if (next == samples.begin()) return samples.front().angular_velocity;
  if (next == samples.end()) return samples.back().angular_velocity;
  return geometry::interpolated(*std::prev(next), *next, time).angular_velocity;
}

/// Poses of earlier frames from which inertial estimation starts, the earliest first.
struct StartPoses {
  std::vector<double> stamps;  // [s]
  std::vector<Eigen::Isometry3d> T_world_camera;
};

/// Which poses a start takes.
struct StartWindow {
  double time, spacing, largest_gap;  // [s]
  std::size_t fewest;                 // poses
  double earliest;                    // time stamp [s]
};

StartWindow start_window(bool scale_is_known, double now, bool is_slow) {
  const double time = scale_is_known ? start_time : start_time_of_one_camera;
  const double spacing = scale_is_known ? pose_spacing : pose_spacing_of_one_camera;
  if (is_slow)
    return {time, spacing, largest_pose_gap_of_slow_camera, fewest_poses_of_slow_camera, now - longest_start_time};
  return {time, spacing, largest_pose_gap, fewest_poses, now - time - largest_pose_gap};
}

/// Chooses poses of tracked frames, `spacing` apart, from the last one backwards until they are enough, or to the first
/// gap.
StartPoses choose_start_poses(const std::vector<double>& tracked, const StartWindow& window,
                              const InertialMotion::PastPose& past_pose) {
  StartPoses chosen;
  for (auto stamp = tracked.rbegin(); stamp != tracked.rend() && *stamp > window.earliest; ++stamp) {
    const std::vector<double>& stamps = chosen.stamps;
    if (stamps.size() >= window.fewest && stamps.front() - stamps.back() >= window.time) break;
    if (!stamps.empty() && stamps.back() - *stamp < window.spacing) continue;
    if (!stamps.empty() && stamps.back() - *stamp > window.largest_gap) break;
    const std::optional<Eigen::Isometry3d> T_camera_world = past_pose(*stamp);
    if (!T_camera_world) continue;
    chosen.stamps.push_back(*stamp);
    chosen.T_world_camera.push_back(T_camera_world->inverse());
  }
  std::reverse(chosen.stamps.begin(), chosen.stamps.end());
  std::reverse(chosen.T_world_camera.begin(), chosen.T_world_camera.end());
  return chosen;
}

/// Motions from each time to the next; empty where samples are missing.
std::optional<std::vector<geometry::Preintegration>> preintegrate_between(const std::vector<ImuSample>& samples,
                                                                          const std::vector<double>& stamps,
                                                                          const ImuNoise& noise, const ImuBias& bias) {
  std::vector<geometry::Preintegration> motions;
  for (std::size_t i = 0; i + 1 < stamps.size(); ++i) {
    const auto motion = geometry::preintegrate(samples, stamps[i], stamps[i + 1], noise, bias);
    if (!motion) return std::nullopt;
    motions.push_back(*motion);
  }
  return motions;
}

/// False for the biases of a solution that diverged.
bool is_possible(const ImuBias& bias) {
  constexpr double most_deviations = 10.0;
  const geometry::InertialStartOptions priors;
  return bias.gyroscope.norm() < most_deviations * priors.gyroscope_bias_deviation &&
         bias.accelerometer.norm() < most_deviations * priors.accelerometer_bias_deviation;
}

/// Whether the motions depend linearly on biases up to these.
bool is_linear(const std::vector<geometry::Preintegration>& motions, const ImuBias& bias) {
  return std::all_of(motions.begin(), motions.end(), [&](const geometry::Preintegration& motion) {
    return motion.duration() * (bias.gyroscope - motion.bias().gyroscope).norm() <= largest_linear_turn;
  });
}

}  // namespace

InertialMotion::InertialMotion(const std::optional<ImuCalibration>& imu, bool scale_is_known)
    : imu_(imu), scale_is_known_(scale_is_known) {}

void InertialMotion::begin_frame(const SensorFrame& frame) {
  if (!imu_) return;
  now_.reset();
  is_corrected_ = is_refused_ = false;
  rate_.reset();
  const std::optional<double> before = std::exchange(timestamp_, frame.timestamp);
  remember_frame();
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
    append_imu(samples_, samples);
  }
}

/// Keeps the stamps of the last seconds, and one before.
void InertialMotion::remember_frame() {
  frames_.push_back(*timestamp_);
  const double begin = *timestamp_ - longest_start_time;
  while (frames_.size() > 2 && frames_[1] < begin) frames_.erase(frames_.begin());
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
  } else {
    tracked_.push_back(*timestamp_);
    if (*timestamp_ >= next_start_) try_to_start(past_pose);
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
                                        mounting_deviation,
                                        time_offset_deviation};
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
  samples_.clear();
  tracked_.clear();
}

void InertialMotion::reset() {
  last_.reset();
  now_.reset();
  anchor_.reset();
  samples_.clear();
  tracked_.clear();
  known_.reset();
  confirmations_ = contradictions_ = refusals_ = known_trials_ = 0;
  scale_ = 1.0;
  next_start_ = 0.0;
}

/// Whether the last frames are too few for a start, even if all of them had a pose.
bool InertialMotion::is_slow_camera() const {
  const double begin = *timestamp_ - start_window(scale_is_known_, *timestamp_, false).time;
  const auto later = std::count_if(frames_.begin(), frames_.end(), [&](double stamp) { return stamp >= begin; });
  return frames_.front() < begin && static_cast<std::size_t>(later) < fewest_poses;
}

void InertialMotion::try_to_start(const PastPose& past_pose) {
  const double now = *timestamp_;
  const bool is_slow = is_slow_camera();
  const StartWindow window = start_window(scale_is_known_, now, is_slow);
  const double earliest = now - longest_start_time - largest_pose_gap;
  std::erase_if(tracked_, [&](double stamp) { return stamp < earliest; });
  const auto first_kept = std::find_if(samples_.begin(), samples_.end(),
                                       [&](const ImuSample& sample) { return sample.timestamp >= earliest; });
  if (first_kept != samples_.begin()) samples_.erase(samples_.begin(), std::prev(first_kept));

  const StartPoses start_poses = choose_start_poses(tracked_, window, past_pose);
  const std::vector<double>& stamps = start_poses.stamps;
  if (stamps.size() < window.fewest || now - stamps.front() < window.time) return;
  next_start_ = now + start_interval;
  const auto unbiased_motions = preintegrate_between(samples_, stamps, imu_->noise, {});
  if (!unbiased_motions) return;
  const std::vector<Eigen::Isometry3d>& poses = start_poses.T_world_camera;
  std::vector<Eigen::Vector3d> rates;
  for (const double stamp : stamps) rates.push_back(rate_at(samples_, stamp));
  geometry::InertialStartOptions options;
  options.estimate_scale = !scale_is_known_;
  options.mounting_deviation = mounting_deviation;
  options.time_offset_deviation = time_offset_deviation;
  // How exact the poses are is unknown: the first deviations that explain their residuals are right. Those of a slow
  // camera have other views of other points than the one before, and not its errors.
  constexpr PoseDeviations possible_deviations[] = {{0.002, 0.001}, {0.005, 0.0025}, {0.01, 0.005}, {0.02, 0.01}};
  for (const PoseDeviations& deviations : std::span(possible_deviations).subspan(is_slow ? 1 : 0, 3)) {
    options.position_deviation = deviations.position;
    options.rotation_deviation = deviations.rotation;
    auto motions = unbiased_motions;
    const auto solve = [&] { return geometry::start_inertially(poses, *motions, imu_->T_body_camera, options, rates); };
    geometry::InertialStart start = solve();
    // Motions depend on the biases linearly between poses that are close in time only.
    for (int i = 0; i < most_integrations && !is_linear(*motions, start.bias) && is_possible(start.bias); ++i) {
      motions = preintegrate_between(samples_, stamps, imu_->noise, start.bias);
      if (!motions) return;
      start = solve();
    }
    if (!start.usable) continue;
    // Their mean squared residual, which is 1 for right deviations, says how wrong these are.
    const double factor = std::sqrt(std::max(1.0, start.mean_chi_square));
    begin_filter(start, poses, *motions, rates, {factor * deviations.position, factor * deviations.rotation});
    return;
  }
}

/// The start gives the values. Their joint covariance is that of a filter that passes the same poses once more, from
/// wide priors.
void InertialMotion::begin_filter(const geometry::InertialStart& start, const std::vector<Eigen::Isometry3d>& poses,
                                  const std::vector<geometry::Preintegration>& motions,
                                  const std::vector<Eigen::Vector3d>& rates, const PoseDeviations& deviations) {
  const geometry::InertialStartOptions priors;
  scale_ = start.scale;
  deviations_ = deviations;
  geometry::InertialState state;
  state.T_world_body = body_pose(poses.front().inverse());
  state.velocity = start.velocities.front();
  state.bias = start.bias;
  state.T_world_body.translation() -= start.time_offset * state.velocity;
  const Eigen::Vector3d turn = start.time_offset * (rates.front() - start.bias.gyroscope);
  state.T_world_body.linear() =
      state.T_world_body.linear() * start.mounting * geometry::exp_so3(-turn).toRotationMatrix();
  constexpr double velocity_prior = 0.2, direction_prior = 0.1;  // [m/s], [rad]
  InertialFilter filter(
      state, start.gravity,
      {deviations.position, deviations.rotation, velocity_prior, priors.gyroscope_bias_deviation,
       priors.accelerometer_bias_deviation, direction_prior, mounting_deviation, time_offset_deviation});
  filter.calibrate(start.mounting, start.time_offset);
  for (std::size_t i = 0; i < motions.size(); ++i) {
    filter.predict(motions[i], rates[i + 1]);
    filter.correct(body_pose(poses[i + 1].inverse()), measurement_covariance(0.0));
  }
  last_ = filter;
  confirmations_ = contradictions_ = refusals_ = 0;
  samples_.clear();
  tracked_.clear();
}

}  // namespace holdfast
