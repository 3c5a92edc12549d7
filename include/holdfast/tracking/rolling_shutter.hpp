// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/geometry/se3.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

/// Motion of the camera from the previous frame to the current one.
struct FrameMotion {
  /// Interval above which constant velocity is no longer a valid assumption, nor the mean motion that at the exposure
  /// [s].
  static constexpr double longest_interval = 0.2;

  geometry::Vector6d tangent;  ///< log of T_current_previous [m, rad]
  double interval;             ///< [s], above 0

  /// T_later_current by constant velocity, for a time `seconds` after the current frame.
  Eigen::Isometry3d during(double seconds) const { return geometry::exp_se3(seconds / interval * tangent); }

  /// This step with its rotation extrapolated towards the end of the step; `previous` is the step before it, scaled to
  /// the same interval. Exact steps would need half an interval (backward difference of second order); the noise of
  /// measured steps grows with the factor, so that it is less. The translation is not extrapolated, since its noise
  /// exceeds the change.
  FrameMotion at_end(const geometry::Vector6d& previous) const {
    constexpr double extrapolation = 0.3;  // intervals
    FrameMotion motion = *this;
    motion.tangent.tail<3>() += extrapolation * (tangent - previous).tail<3>();
    return motion;
  }
};

/// Correction of the rolling shutter (Ringaby and Forssen, "Efficient Video Rectification and Stabilisation for
/// Cell-Phones", IJCV 2012), which exposes the rows of an image one after another: for a rotation of 1 rad/s and a
/// readout of 26 ms (Kinect), the last row is displaced by 13 px relative to the first. Features are moved to their
/// positions in a global-shutter image at the time of the middle row:
///
///   X' = T(-t) X,  t = (row / height - 1/2) * readout,  T(t) = exp(t * velocity)
///
/// to second order in t, where X is the 3-D position of the feature in the camera frame.
///
/// The readout time can be estimated, by one Gauss-Newton step per tracked frame: the squared reprojection errors of
/// the inliers are linearised in the pose and the readout time, and the pose is eliminated by the Schur complement. Map
/// points were observed with earlier estimates, so that a step is too short, although it vanishes at the true value;
/// steps are therefore enlarged, and averaged by their information. One thread.
class RollingShutter {
 public:
  /// `readout`: of the camera, see Camera::readout.
  RollingShutter(RollingShutterMode mode, double readout);

  /// True if correct() has an effect.
  bool is_active() const { return mode_ != RollingShutterMode::off && readout_ != 0.0; }
  bool is_estimated() const { return mode_ == RollingShutterMode::estimated; }
  /// Current readout time [s].
  double readout() const { return readout_; }

  /// Corrects frame.x, y, depth and right_x; the grid is not updated. Features without depth use that of their map
  /// point (by frame.T_camera_world) or a typical depth; the map is read only in this case.
  void correct(const FrameMotion& motion, const Map& map, Frame& frame) const;
  /// Updates the estimate by a frame with final pose and inlier map points, whose features were corrected for `motion`.
  /// Has no effect unless the readout time is estimated.
  void learn(const FrameMotion& motion, const Map& map, const Frame& frame);

 private:
  RollingShutterMode mode_;
  double readout_;
  double information_;  ///< of the steps that the estimate remembers [px^2/s^2]
};

}  // namespace holdfast
