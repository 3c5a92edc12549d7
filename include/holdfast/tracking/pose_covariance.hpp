// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <utility>
#include <vector>

#include "holdfast/core/id.hpp"
#include "holdfast/geometry/se3.hpp"
#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast {

/// Covariances of adjusted poses: translation [m] and rotation [rad] in the camera frame. `problem` is the solved one
/// and `inverse_information` its PoseSummary::covariance, for unit variance of the weighted residuals. The first
/// calls allocate. One thread.
class PoseCovariance {
 public:
  /// Side of a cell of image within which errors are taken as dependent [rad].
  static constexpr double cell_angle = 0.056;
  /// A frame and its reference keyframe see the same points, so that a share of their errors is common and cancels: the
  /// sum of both covariances is too large. Chosen by the normalised estimation error squared (NEES) of the frames of
  /// forty simulated recordings: benchmarks/tools/measure_health.py.
  static constexpr double independent_share = 0.85;

  /// Covariance of the error of a pose relative to its reference keyframe: that of the frame, whose errors are
  /// dependent between neighbours (clustered()), and that of the keyframe, of which `T_current_reference` is the
  /// motion: the one that it had as a frame, at least independent() of this frame. An invalid or unknown `reference`
  /// has the latter.
  geometry::Matrix6d calibrated_covariance(const PoseProblem& problem, const geometry::Matrix6d& inverse_information,
                                           KeyFrameId reference, const Eigen::Isometry3d& T_current_reference);
  /// A frame begins, which may end without a call of calibrated_covariance().
  void begin_frame() { has_frame_ = false; }
  /// The frame became this keyframe.
  void keyframe_added(KeyFrameId keyframe);
  void forget_map() { keyframes_.clear(), next_ = 0, has_frame_ = false; }

  /// Covariance for errors that are independent between matches: `inverse_information` times the variance factor of the
  /// residuals (sum of squares by degrees of freedom; Foerstner and Wrobel 2016, section 4.2.3).
  static geometry::Matrix6d independent(const PoseProblem& problem, const geometry::Matrix6d& inverse_information);
  /// Covariance for errors that may depend on each other within a cell of the image, and have any variance
  /// ("Longitudinal data analysis using generalized linear models", Liang and Zeger, Biometrika 1986, equation 2.5:
  /// the outer products of the gradients' sums over cells between two inverse Hessians). Neighbouring points
  /// lie on one surface and were placed by the same keyframes, so that a frame at some distance from
  /// these sees their errors of depth as common shifts, which residuals that are taken one by one do not show.
  geometry::Matrix6d clustered(const PoseProblem& problem, const geometry::Matrix6d& inverse_information);

 private:
  static constexpr std::size_t most_keyframes = 64;  ///< the oldest are forgotten

  const geometry::Matrix6d* find(KeyFrameId keyframe) const;

  std::vector<geometry::Vector6d> gradients_;                         // by cell
  std::vector<std::pair<KeyFrameId, geometry::Matrix6d>> keyframes_;  // a ring
  std::size_t next_ = 0;
  geometry::Matrix6d frame_;  // independent() of the last frame
  bool has_frame_ = false;
};

}  // namespace holdfast
