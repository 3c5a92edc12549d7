// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/geometry/se3.hpp"
#include "holdfast/tracking/tracking_settings.hpp"

namespace holdfast {

/// How the camera moved from the previous frame to the current one.
struct FrameMotion {
  geometry::Vector6d tangent;  ///< log of T_current_previous [m, rad]
  double interval;             ///< [s], above 0

  /// T_later_current, by constant velocity, for a moment `seconds` after the current frame.
  Eigen::Isometry3d during(double seconds) const { return geometry::exp_se3(seconds / interval * tangent); }
};

/// A rolling shutter exposes the rows of an image one after another. While a camera turns by 1 rad/s, the readout of a
/// Kinect, 26 ms, moves the last row by 13 px against the first (Ringaby and Forssen, "Efficient Video Rectification
/// and Stabilisation for Cell-Phones", IJCV 2012). This class takes features to where an image exposed at once, at the
/// time of its middle row, would show them:
///
///   X' = T(-t) X,  t = (row / height - 1/2) * readout,  T(t) = exp(t * velocity)
///
/// to the second order in t, where X is the feature at its depth in the camera frame.
///
/// The readout time can be estimated. Every tracked frame is one Gauss-Newton step of it: the sum of squared
/// reprojection errors of its inliers, linearised in the pose and in the readout time, with the pose eliminated by the
/// Schur complement. Points of the map were themselves seen with the previous estimates, so that a step falls short of
/// the truth, while its zero lies where it should; steps are therefore enlarged, and averaged by their information.
/// One thread.
class RollingShutter {
 public:
  /// `readout`: of the camera, see Camera::readout.
  RollingShutter(RollingShutterMode mode, double readout);

  /// Whether correct() changes anything.
  bool is_active() const { return mode_ != RollingShutterMode::off && readout_ != 0.0; }
  bool is_estimated() const { return mode_ == RollingShutterMode::estimated; }
  /// The time in use now [s].
  double readout() const { return readout_; }

  /// Moves frame.x, y, depth and right_x, which are those of the rows' exposures; the grid is left as it is. Features
  /// without depth have that of their map point by frame.T_camera_world, or a typical one: only
  /// then is the map read.
  void correct(const FrameMotion& motion, const Map& map, Frame& frame) const;
  /// Improves the estimate by a frame with its final pose, whose map points agree with it, and whose features were
  /// corrected for `motion`; does nothing unless the time is estimated.
  void learn(const FrameMotion& motion, const Map& map, const Frame& frame);

 private:
  RollingShutterMode mode_;
  double readout_;
  double information_;  ///< of the steps that the estimate remembers [px^2/s^2]
};

}  // namespace holdfast
