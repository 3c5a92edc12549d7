// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>

namespace holdfast {

/// Alignment of an estimated trajectory with the ground truth before the absolute error is computed.
enum class AlignmentKind {
  se3,   ///< rotation and translation: for estimates with metric scale
  sim3,  ///< rotation, translation and scale: for monocular estimates
  none,  ///< no alignment: both have the same world frame
};

/// "se3", "sim3", "none".
std::string_view to_string(AlignmentKind kind);
std::optional<AlignmentKind> parse_alignment(std::string_view name);

/// truth ~ scale * rotation * estimate + translation.
struct TrajectoryAlignment {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  ///< [m]
  double scale = 1.0;

  Eigen::Vector3d apply(const Eigen::Vector3d& position) const;
};

/// Least-squares alignment of corresponding positions, one per column (Umeyama 1991, equations 40 to 43; without scale
/// identical to Horn 1987). Both need the same number of columns, at least 3. Throws Error for sim3 if all positions of
/// the estimate coincide, because the scale is then undefined.
TrajectoryAlignment align_positions(const Eigen::Matrix3Xd& estimate, const Eigen::Matrix3Xd& truth,
                                    AlignmentKind kind);

}  // namespace holdfast
