// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "holdfast/core/check.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/geometry/ransac.hpp"

namespace holdfast::geometry {

/// target = scale * rotation * source + translation.
struct Similarity {
  double scale = 1.0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return scale * (rotation * point) + translation; }
  /// Rotation and translation as a pose; only meaningful with scale 1.
  Eigen::Isometry3d motion() const {
    Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
    result.linear() = rotation;
    result.translation() = translation;
    return result;
  }
};

namespace detail {

/// Marks points within the threshold as inliers and returns their number; points that are not finite are outliers.
inline int mark_inliers(std::span<const Eigen::Vector3d> source, std::span<const Eigen::Vector3d> target,
                        const Similarity& similarity, double threshold, std::vector<std::uint8_t>& inlier) {
  int count = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    inlier[i] = (similarity * source[i] - target[i]).squaredNorm() <= threshold * threshold;
    count += inlier[i];
  }
  return count;
}

}  // namespace detail

/// Least-squares rigid motion (or, `with_scale`, similarity) from source to target points, in closed form (Umeyama,
/// "Least-squares estimation of transformation parameters between two point patterns", PAMI 13(4), 1991, equations 40
/// to 42). Empty for fewer than three points, points on one line, or numbers that are not finite; different sizes throw
/// CheckError.
inline std::optional<Similarity> align_points(std::span<const Eigen::Vector3d> source,
                                              std::span<const Eigen::Vector3d> target, bool with_scale = false) {
  HOLDFAST_CHECK(source.size() == target.size(), "source " << source.size() << " target " << target.size());
  if (source.size() < 3) return std::nullopt;
  const double count = static_cast<double>(source.size());
  Eigen::Vector3d source_mean = Eigen::Vector3d::Zero(), target_mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < source.size(); ++i) source_mean += source[i], target_mean += target[i];
  source_mean /= count, target_mean /= count;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double variance = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3d centred = source[i] - source_mean;
    covariance += (target[i] - target_mean) * centred.transpose();
    variance += centred.squaredNorm();
  }
  covariance /= count, variance /= count;
  if (!covariance.allFinite()) return std::nullopt;

  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d singular = svd.singularValues();
  if (!(singular[1] > 1e-9 * singular[0])) return std::nullopt;
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) sign[2] = -1.0;
  Similarity result;
  result.rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  if (with_scale) result.scale = singular.dot(sign) / variance;
  result.translation = target_mean - result.scale * (result.rotation * source_mean);
  return result;
}

/// Sampling and stopping rules of align_points_ransac().
struct AlignmentRansacOptions {
  bool with_scale = false;
  double threshold = 0.05;    ///< largest distance of an inlier, in units of the target [m]
  int iterations = 200;       ///< at most
  double confidence = 0.999;  ///< sampling stops when the probability of a better sample is below 1 - confidence
  int minimum_inliers = 6;
  std::uint64_t seed = 1;
};

/// The best alignment and its inliers.
struct AlignmentRansacResult {
  Similarity similarity;
  std::vector<std::uint8_t> inlier;
  int inliers = 0;
};

/// RANSAC (Fischler and Bolles 1981): align_points on random samples of three, then on all inliers of the best sample.
/// The same input and seed give the same result. Empty when fewer than minimum_inliers agree; different sizes throw
/// CheckError.
inline std::optional<AlignmentRansacResult> align_points_ransac(std::span<const Eigen::Vector3d> source,
                                                                std::span<const Eigen::Vector3d> target,
                                                                const AlignmentRansacOptions& options = {}) {
  HOLDFAST_CHECK(source.size() == target.size(), "source " << source.size() << " target " << target.size());
  if (source.size() < 3) return std::nullopt;
  Random random(options.seed);
  AlignmentRansacResult best;
  std::vector<std::uint8_t> inlier(source.size());
  int iterations = options.iterations;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const auto sample = sample_without_repeat<3>(random, static_cast<std::uint32_t>(source.size()));
    const std::array<Eigen::Vector3d, 3> from = {source[sample[0]], source[sample[1]], source[sample[2]]};
    const std::array<Eigen::Vector3d, 3> to = {target[sample[0]], target[sample[1]], target[sample[2]]};
    const auto similarity = align_points(from, to, options.with_scale);
    if (!similarity) continue;
    const int inliers = detail::mark_inliers(source, target, *similarity, options.threshold, inlier);
    if (inliers <= best.inliers) continue;
    best = {*similarity, inlier, inliers};
    iterations = ransac_iterations(static_cast<double>(inliers) / static_cast<double>(source.size()), 3,
                                   options.confidence, options.iterations);
  }
  if (best.inliers < std::max(3, options.minimum_inliers)) return std::nullopt;

  std::vector<Eigen::Vector3d> from, to;
  for (std::size_t i = 0; i < source.size(); ++i)
    if (best.inlier[i]) from.push_back(source[i]), to.push_back(target[i]);
  if (const auto refined = align_points(from, to, options.with_scale)) {
    const int inliers = detail::mark_inliers(source, target, *refined, options.threshold, inlier);
    if (inliers >= best.inliers) best = {*refined, inlier, inliers};
  }
  return best;
}

}  // namespace holdfast::geometry
