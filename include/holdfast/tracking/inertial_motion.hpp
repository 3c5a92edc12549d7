// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "holdfast/core/imu.hpp"
#include "holdfast/core/map_inertia.hpp"
#include "holdfast/core/predicted_pose.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/tracking/inertial_filter.hpp"
#include "holdfast/tracking/inertial_starter.hpp"

namespace holdfast {

/// A pose that inertial measurements predict.
struct InertialPrediction : PredictedPose {
  double position_deviation = 0.0;  ///< the larger axis, in the unit of the map
  double rotation_deviation = 0.0;  ///< the larger axis [rad]
};

/// Motion of the camera by inertial measurements. First, gravity, biases, velocity and, with one camera, the scale are
/// estimated from the tracked poses of the last seconds (InertialStarter); then an InertialFilter keeps them up to
/// date. The filter must predict some poses before others use it (is_reliable); one that contradicts the images for
/// long, or misses measurements, ends, and the start begins again. Until then, and without an IMU, it predicts nothing.
/// Where gravity, biases and scale are known, from the map or from before a gap, a filter begins with the first pose,
/// and learns the velocity from the next ones. A prediction over more than 0.2 s, as of a slow camera, counts as three.
///
/// For each frame, begin_frame() is called first, then follow_map(), and one of found(), bridged() and lost() last.
/// Poses are those of the camera in the map. Deterministic. One thread.
class InertialMotion {
 public:
  /// Without a calibration nothing is ever predicted. `scale_is_known`: the unit of the map is the metre.
  InertialMotion(const std::optional<ImuCalibration>& imu, bool scale_is_known);

  /// Estimates of an earlier run in the map, to begin with.
  void begin_with(const MapInertia& known) { known_ = known; }
  /// Whether there is an IMU.
  bool is_used() const { return imu_.has_value(); }
  /// Propagates to the time stamp of a frame by its measurements.
  void begin_frame(const SensorFrame& frame);
  /// `T_camera_world`: of the last frame with a pose, by the map as it is now; corrections of the map move the state.
  void follow_map(const Eigen::Isometry3d& T_camera_world);

  /// Whether gravity, biases and velocity are known.
  bool is_started() const { return last_.has_value(); }
  /// Whether they have also predicted poses that images confirmed; then predictions are used.
  bool is_reliable() const { return now_.has_value() && confirmations_ >= required_confirmations; }
  /// T_current_previous from the frame before, whether it had a pose or not; empty unless reliable.
  std::optional<Eigen::Isometry3d> step() const;
  /// Angular velocity of the camera, in its frame, at the time stamp of the current frame [rad/s]; empty unless
  /// reliable.
  std::optional<Eigen::Vector3d> turn_rate() const;
  /// Empty unless reliable.
  std::optional<InertialPrediction> prediction() const;
  /// Whether a pose is farther from the prediction than both their uncertainties and `factor` allow; false unless
  /// reliable.
  bool contradicts(const Eigen::Isometry3d& T_camera_world, double factor) const;
  /// Counts the current pose, which ample static points of the map determine, if it contradicts the prediction by
  /// `factor`: the estimate ends where such poses contradict it in several frames in a row. To be called before
  /// contradicts().
  void count_refusal(const Eigen::Isometry3d& T_camera_world, double factor);
  /// Corrects the prediction for the current frame by a pose that few features determine, with the covariance of
  /// PoseSummary; `is_relative`: these features are placed by the pose of the previous frame, so that its error is part
  /// of this one's. False if it contradicts the prediction, which stays as it is.
  bool correct(const Eigen::Isometry3d& T_camera_world, const Eigen::Matrix<double, 6, 6>& covariance,
               bool is_relative);

  using PastPose = InertialStarter::PastPose;
  /// The images determined the current pose, which correct() has not got, with this standard deviation of the position,
  /// as the matches determine it.
  void found(const Eigen::Isometry3d& T_camera_world, double deviation, const PastPose& past_pose);
  /// The current pose is the prediction, which may have been corrected.
  void bridged(const Eigen::Isometry3d& T_camera_world) { keep_prediction(T_camera_world); }
  /// The current frame has no pose.
  void lost();
  /// The map alone gives the current pose, which contradicts the prediction, and found() gets it next: the state begins
  /// again there, with gravity, biases and calibration as they are.
  void relocated() { interrupt(); }
  /// Begins again with nothing known, as where the map begins.
  void reset();
  /// Gravity in the world of the map [m/s^2]; empty unless the state at the last frame is reliable.
  std::optional<Eigen::Vector3d> gravity() const {
    return last_ && confirmations_ >= required_confirmations ? std::optional(last_->gravity()) : std::nullopt;
  }
  /// The estimates, for maps: of the current state if it is reliable, or else what a filter begins with.
  std::optional<MapInertia> estimates() const;

  /// The state at the last frame, in metres, whose biases, velocity and gravity are estimates; empty before the start.
  const std::optional<InertialFilter>& filter() const { return last_; }
  /// Metres in a unit of the map.
  double scale() const { return scale_; }

 private:
  static constexpr int required_confirmations = 10;

  Eigen::Isometry3d body_pose(const Eigen::Isometry3d& T_camera_world) const;
  Eigen::Isometry3d camera_pose(const Eigen::Isometry3d& T_world_body) const;
  InertialFilter::PoseCovariance measurement_covariance(double deviation) const;
  void keep_prediction(const Eigen::Isometry3d& T_camera_world);
  void interrupt();
  void refute();
  void learn(const Eigen::Isometry3d& T_camera_world, double deviation);
  void begin_with_known(const Eigen::Isometry3d& T_camera_world);
  void begin_filter(const FoundInertialStart& found);

  const std::optional<ImuCalibration> imu_;
  const bool scale_is_known_;
  std::optional<InertialStarter> starter_;    // with an IMU
  std::optional<double> timestamp_;           // of the last frame [s]
  std::optional<InertialFilter> last_, now_;  // at the last frame, and predicted for the current one
  std::optional<Eigen::Isometry3d> anchor_;   // T_camera_world of the last frame with a pose, to which last_ belongs
  double scale_ = 1.0;
  PoseDeviations deviations_;                                  // as the start found them
  int confirmations_ = 0, contradictions_ = 0, refusals_ = 0;  // the latter two in a row
  int weight_ = 1;                                             // of the current frame in these
  bool is_refused_ = false;                                    // the current frame is counted in refusals_
  bool is_corrected_ = false;                                  // now_ knows the current pose
  double mean_turn_rate_ = 0.0;                                // of the current frame [rad/s]
  double found_time_ = 0.0;                                    // [s]
  std::optional<Eigen::Vector3d> rate_;                        // measured at the current frame [rad/s]
  std::optional<MapInertia> known_;                            // a filter begins with it
  int known_trials_ = 0;
};

}  // namespace holdfast
