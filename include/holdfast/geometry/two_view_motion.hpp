// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "holdfast/core/random.hpp"
#include "holdfast/geometry/eight_point.hpp"
#include "holdfast/geometry/epipolar.hpp"
#include "holdfast/geometry/pinhole.hpp"
#include "holdfast/geometry/ransac.hpp"
#include "holdfast/geometry/triangulation.hpp"

namespace holdfast::geometry {

/// A feature matched in two views, without lens distortion.
struct PixelPair {
  Eigen::Vector2d a, b;   ///< [px]
  double sigma2_a = 1.0;  ///< variance of a pixel coordinate in a [px^2]
  double sigma2_b = 1.0;  ///< in b [px^2]
};

/// Conditions of find_two_view_motion().
struct TwoViewOptions {
  int iterations = 200;            ///< samples of eight pairs, for both models
  double homography_share = 0.45;  ///< share of the homography in both scores above which it is chosen (equation 5)
  int minimum_points = 50;         ///< minimum number of points with enough parallax in front of both cameras
  double minimum_inliers = 0.5;    ///< minimum share of inliers of the chosen model
  double minimum_share = 0.75;  ///< minimum share of these inliers that are in front of both cameras and reproject well
  double rival_share = 0.75;    ///< a second motion that explains more than this share makes the result ambiguous
  double max_parallax_cosine = 0.99985;  ///< 1 degree
  std::uint64_t seed = 1;
};

/// Relative pose of two views and the triangulated points.
struct TwoViewMotion {
  Eigen::Isometry3d T_b_a = Eigen::Isometry3d::Identity();  ///< its translation has unit length
  bool is_planar = false;                                   ///< whether the homography was chosen
  std::vector<Eigen::Vector3d> points;                      ///< one for each pair, in camera a
  std::vector<std::uint8_t> good;                           ///< whether the point can be used
  int good_points = 0;
};

namespace detail {

/// Scores a model by the errors of all pairs in both images (Mur-Artal et al. 2015, equations 2 and 3).
struct TwoViewModel {
  double score = 0.0;
  std::vector<std::uint8_t> inlier;
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();

  template <class ErrorIn>
  void evaluate(std::span<const PixelPair> pairs, const Eigen::Matrix3d& candidate, double limit, ErrorIn&& errors) {
    constexpr double gamma = 5.991;
    double sum = 0.0;
    scratch_.assign(pairs.size(), 0);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const Eigen::Vector2d error = errors(pairs[i]);  // squared and divided by the variance, in a and in b
      if (error.x() < limit) sum += gamma - error.x();
      if (error.y() < limit) sum += gamma - error.y();
      scratch_[i] = error.x() < limit && error.y() < limit;
    }
    if (!(sum > score)) return;
    score = sum;
    matrix = candidate;
    inlier.swap(scratch_);
  }

 private:
  std::vector<std::uint8_t> scratch_;
};

inline void score_fundamental(std::span<const PixelPair> pairs, const Eigen::Matrix3d& fundamental,
                              TwoViewModel& best) {
  const Eigen::Matrix3d transposed = fundamental.transpose();
  best.evaluate(pairs, fundamental, 3.841, [&](const PixelPair& pair) {
    const double in_b = epipolar_line(fundamental, pair.a).distance2(pair.b.x(), pair.b.y()) / pair.sigma2_b;
    const double in_a = epipolar_line(transposed, pair.b).distance2(pair.a.x(), pair.a.y()) / pair.sigma2_a;
    return Eigen::Vector2d(in_a, in_b);
  });
}

inline void score_homography(std::span<const PixelPair> pairs, const Eigen::Matrix3d& homography, TwoViewModel& best) {
  const Eigen::Matrix3d inverse = homography.inverse();
  if (!inverse.allFinite()) return;
  best.evaluate(pairs, homography, 5.991, [&](const PixelPair& pair) {
    const Eigen::Vector2d in_b = (homography * pair.a.homogeneous()).hnormalized() - pair.b;
    const Eigen::Vector2d in_a = (inverse * pair.b.homogeneous()).hnormalized() - pair.a;
    return Eigen::Vector2d(in_a.squaredNorm() / pair.sigma2_a, in_b.squaredNorm() / pair.sigma2_b);
  });
}

/// Evaluation of a motion by the inliers of a model.
struct TwoViewHypothesis {
  TwoViewMotion motion;
  int explained = 0;  // points of any parallax that are in front of both cameras and project onto their pixels
};

inline TwoViewHypothesis explain(const Pinhole& camera, std::span<const PixelPair> pairs,
                                 const std::vector<std::uint8_t>& inlier, const Eigen::Isometry3d& T_b_a,
                                 double max_parallax_cosine) {
  TwoViewHypothesis result;
  result.motion.T_b_a = T_b_a;
  result.motion.points.assign(pairs.size(), Eigen::Vector3d::Zero());
  result.motion.good.assign(pairs.size(), 0);
  constexpr double no_parallax_limit = 1.0 - 1e-7;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (inlier[i] == 0) continue;
    const TriangulatedPoint point =
        triangulate(camera, PointView{Eigen::Isometry3d::Identity(), pairs[i].a, pairs[i].sigma2_a},
                    PointView{T_b_a, pairs[i].b, pairs[i].sigma2_b}, {.max_parallax_cosine = no_parallax_limit});
    if (point.status != TriangulationStatus::good) continue;
    ++result.explained;
    if (point.parallax_cosine > max_parallax_cosine) continue;
    result.motion.points[i] = point.point;
    result.motion.good[i] = 1;
    ++result.motion.good_points;
  }
  return result;
}

}  // namespace detail

/// Two-view initialisation of one camera (Mur-Artal et al. 2015, section IV): a homography and a fundamental matrix are
/// estimated from the same samples, the better scored one is chosen, and decomposed; the motion with clearly more
/// points in front of both cameras is selected (cheirality). Empty if there are too few pairs, too little parallax, or
/// an ambiguity (a second motion explains nearly as many points), as often for a planar scene. The same input and seed
/// give the same result. Any camera type with CameraTraits.
template <class Camera>
std::optional<TwoViewMotion> find_two_view_motion(const Camera& camera_model, std::span<const PixelPair> pairs,
                                                  const TwoViewOptions& options = {}) {
  constexpr std::size_t sample_size = 8;
  if (pairs.size() < std::max<std::size_t>(sample_size, static_cast<std::size_t>(options.minimum_points)))
    return std::nullopt;
  const Pinhole camera = pinhole_of(camera_model);
  Random random(options.seed);
  detail::TwoViewModel fundamental, homography;
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    const auto sample = sample_without_repeat<sample_size>(random, static_cast<std::uint32_t>(pairs.size()));
    std::array<Eigen::Vector2d, sample_size> a, b;
    for (std::size_t k = 0; k < sample_size; ++k) a[k] = pairs[sample[k]].a, b[k] = pairs[sample[k]].b;
    if (const auto matrix = estimate_fundamental(a, b)) detail::score_fundamental(pairs, *matrix, fundamental);
    if (const auto matrix = estimate_homography(a, b)) detail::score_homography(pairs, *matrix, homography);
  }
  if (!(fundamental.score + homography.score > 0.0)) return std::nullopt;

  // Re-estimate the chosen model from all its inliers.
  const bool is_planar = homography.score > options.homography_share * (fundamental.score + homography.score);
  detail::TwoViewModel& model = is_planar ? homography : fundamental;
  std::vector<Eigen::Vector2d> a, b;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (model.inlier[i] != 0) a.push_back(pairs[i].a), b.push_back(pairs[i].b);
  if (const auto refined = is_planar ? estimate_homography(a, b) : estimate_fundamental(a, b)) {
    if (is_planar)
      detail::score_homography(pairs, *refined, model);
    else
      detail::score_fundamental(pairs, *refined, model);
  }
  const int inliers = static_cast<int>(std::count(model.inlier.begin(), model.inlier.end(), std::uint8_t{1}));

  if (inliers < options.minimum_inliers * static_cast<double>(pairs.size())) return std::nullopt;
  Eigen::Matrix3d to_pixel;
  to_pixel << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  std::array<Eigen::Isometry3d, 4> motions;
  if (is_planar) {
    const auto allowed = decompose_homography(to_pixel.inverse() * model.matrix * to_pixel);
    if (!allowed) return std::nullopt;
    motions = *allowed;
  } else {
    motions = decompose_essential(to_pixel.transpose() * model.matrix * to_pixel);
  }
  std::vector<detail::TwoViewHypothesis> hypotheses;
  for (const Eigen::Isometry3d& motion : motions)
    hypotheses.push_back(detail::explain(camera, pairs, model.inlier, motion, options.max_parallax_cosine));
  detail::TwoViewHypothesis& best =
      *std::max_element(hypotheses.begin(), hypotheses.end(),
                        [](const auto& one, const auto& other) { return one.explained < other.explained; });
  int rival = 0;
  for (const detail::TwoViewHypothesis& other : hypotheses) {
    // Straight towards a plane, two of the motions of a homography are the same.
    const Eigen::Isometry3d change = other.motion.T_b_a * best.motion.T_b_a.inverse();
    const bool is_same = change.linear().trace() > 2.999 &&
                         other.motion.T_b_a.translation().dot(best.motion.T_b_a.translation()) > 0.999;
    if (!is_same) rival = std::max(rival, other.explained);
  }
  if (best.explained < options.minimum_share * inliers || rival > options.rival_share * best.explained ||
      best.motion.good_points < options.minimum_points)
    return std::nullopt;
  best.motion.is_planar = is_planar;
  return std::move(best.motion);
}

}  // namespace holdfast::geometry
