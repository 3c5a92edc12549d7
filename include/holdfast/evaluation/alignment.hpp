// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>

namespace holdfast {

/// How an estimate is laid onto the truth before the absolute error is taken.
enum class AlignmentKind {
  se3,   ///< rotation and translation: for estimates of metric scale
  sim3,  ///< and one scale: for monocular estimates
  none,  ///< as they are: both are in the same world frame already
};

/// "se3", "sim3", "none".
std::string_view to_string(AlignmentKind kind);
std::optional<AlignmentKind> parse_alignment(std::string_view name);

/// truth ~ scale * rotation * estimate + translation.
struct TrajectoryAlignment {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  ///< [m]
  double scale = 1.0;

  Eigen::Vector3d apply(const Eigen::Vector3d& position) const { return scale * (rotation * position) + translation; }
};

/// The least-squares alignment of paired positions, one per column (Umeyama 1991, equations 40 to 43; without scale the
/// same as Horn 1987). At least 3 columns, both of the same number. Throws Error for sim3 when all positions of the
/// estimate are one, because no scale follows from that.
TrajectoryAlignment align_positions(const Eigen::Matrix3Xd& estimate, const Eigen::Matrix3Xd& truth,
                                    AlignmentKind kind);

}  // namespace holdfast
