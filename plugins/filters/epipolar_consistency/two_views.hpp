// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "holdfast/core/random.hpp"

/// Two-view geometry of point pairs, with a test for degeneracy (Hartley and Zisserman, Multiple View Geometry, 2004,
/// chapters 4 and 11).
namespace holdfast::epipolar_consistency_plugin {

/// Positions of points in view a (earlier) and view b (current): undistorted pixels minus the principal point, divided
/// by the focal length. Entry i of every array belongs to pair i.
struct PointPairs {
  std::vector<float> ax, ay, bx, by;
  std::vector<std::uint8_t> trusted;  ///< 0 = not used for the estimation

  std::size_t size() const { return ax.size(); }
  void clear() { ax.clear(), ay.clear(), bx.clear(), by.clear(), trusted.clear(); }
  void add(float a_x, float a_y, float b_x, float b_y, bool is_trusted) {
    ax.push_back(a_x), ay.push_back(a_y), bx.push_back(b_x), by.push_back(b_y), trusted.push_back(is_trusted ? 1 : 0);
  }
};

/// Squared distances of the points in b from the epipolar lines of those in a.
void epipolar_distances2(const Eigen::Matrix3d& fundamental, const PointPairs& pairs, std::vector<float>& distance2);
/// Squared distances of the points in b from the points in a transferred by a homography.
void transfer_distances2(const Eigen::Matrix3d& homography, const PointPairs& pairs, std::vector<float>& distance2);

enum class Verdict : std::uint8_t {
  usable,
  few_points,   ///< too few trusted pairs
  no_support,   ///< too few inliers of any fundamental matrix: moving points in the majority, or wrong flow
  no_parallax,  ///< degenerate: a homography fits nearly as well (rotation, small baseline, plane)
};

struct TwoViewOptions {
  double threshold = 0.0029;     ///< maximum distance of an inlier from its epipolar line
  double parallax = 0.0013;      ///< minimum distance from the homography's transfer for parallax
  double parallax_share = 0.35;  ///< minimum fraction of the inliers with parallax
  double support = 0.5;          ///< minimum inlier fraction of the trusted pairs
  int iterations = 500;          ///< maximum number of RANSAC samples
  double confidence = 0.9999;
};

/// Estimates the fundamental matrix of the trusted pairs and tests it for degeneracy: RANSAC with eight-point samples
/// (solved exactly) and least squares over the inliers, followed by a homography from the same pairs by the same
/// method. Reuses its buffers; the same pairs and generator give the same result. One thread.
class TwoViews {
 public:
  explicit TwoViews(const TwoViewOptions& options) : options_(options) {}

  /// If the verdict is `usable`, distance2() and fundamental() are valid for all pairs, trusted or not.
  Verdict estimate(const PointPairs& pairs, Random& random);

  const Eigen::Matrix3d& fundamental() const { return fundamental_; }
  const std::vector<float>& distance2() const { return distance2_; }
  /// Inlier fraction of the trusted pairs in the last estimation, and fraction of the inliers with parallax.
  double support() const { return support_; }
  double parallax_share() const { return parallax_share_; }

 private:
  void choose_trusted(const PointPairs& pairs);
  bool find_fundamental(Random& random);
  bool find_homography(Random& random);

  TwoViewOptions options_;
  PointPairs chosen_;  // trusted pairs that the estimation uses
  PointPairs supporting_;
  std::vector<float> distance2_, work_;
  Eigen::Matrix3d fundamental_ = Eigen::Matrix3d::Zero(), homography_ = Eigen::Matrix3d::Identity();
  double support_ = 0.0, parallax_share_ = 0.0;
};

}  // namespace holdfast::epipolar_consistency_plugin
