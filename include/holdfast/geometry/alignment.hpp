// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace holdfast::geometry {

/// target = scale * rotation * source + translation.
struct Similarity {
  double scale = 1.0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return scale * (rotation * point) + translation; }
  /// Rotation and translation as a pose; only meaningful with scale 1.
  Eigen::Isometry3d motion() const;
};

/// The motion (or, `with_scale`, the similarity) that takes source points to target points with the least squared
/// distance, in closed form (Umeyama, "Least-squares estimation of transformation parameters between two point
/// patterns", PAMI 13(4), 1991, equations 40 to 42). Nothing for fewer than three points, points on one line, or
/// numbers that are not finite; different sizes throw CheckError.
std::optional<Similarity> align_points(std::span<const Eigen::Vector3d> source, std::span<const Eigen::Vector3d> target,
                                       bool with_scale = false);

/// How align_points_ransac() draws and judges its samples.
struct AlignmentRansacOptions {
  bool with_scale = false;
  double threshold = 0.05;    ///< largest distance of an inlier, in units of the target [m]
  int iterations = 200;       ///< at most
  double confidence = 0.999;  ///< stop when a better sample is this unlikely
  int minimum_inliers = 6;
  std::uint64_t seed = 1;
};

/// The best alignment, and which pairs agree with it.
struct AlignmentRansacResult {
  Similarity similarity;
  std::vector<std::uint8_t> inlier;
  int inliers = 0;
};

/// align_points from samples of three, then again from all inliers of the best (Fischler and Bolles 1981). The same
/// input and seed give the same result. Nothing when fewer than minimum_inliers agree.
std::optional<AlignmentRansacResult> align_points_ransac(std::span<const Eigen::Vector3d> source,
                                                         std::span<const Eigen::Vector3d> target,
                                                         const AlignmentRansacOptions& options = {});

}  // namespace holdfast::geometry
