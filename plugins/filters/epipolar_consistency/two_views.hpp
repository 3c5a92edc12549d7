// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "holdfast/core/random.hpp"

/// What two views of a scene say about which points move (Hartley and Zisserman, Multiple View Geometry, 2004, chapters
/// 4 and 11), for points between which nothing is known but where they are seen.
namespace holdfast::epipolar_plugin {

/// Where points are seen in view a (earlier) and view b (now): undistorted pixels, less the principal point, divided by
/// the focal length. Entry i of every array belongs to pair i.
struct PointPairs {
  std::vector<float> ax, ay, bx, by;
  std::vector<std::uint8_t> trusted;  ///< 0 = not to be used for the estimate

  std::size_t size() const { return ax.size(); }
  void clear() { ax.clear(), ay.clear(), bx.clear(), by.clear(), trusted.clear(); }
  void add(float a_x, float a_y, float b_x, float b_y, bool is_trusted) {
    ax.push_back(a_x), ay.push_back(a_y), bx.push_back(b_x), by.push_back(b_y), trusted.push_back(is_trusted ? 1 : 0);
  }
};

/// Squared distances of the points in b from the epipolar lines of those in a.
void epipolar_distances2(const Eigen::Matrix3d& fundamental, const PointPairs& pairs, std::vector<float>& distance2);
/// Squared distances of the points in b from where a homography takes those in a.
void transfer_distances2(const Eigen::Matrix3d& homography, const PointPairs& pairs, std::vector<float>& distance2);

enum class Verdict : std::uint8_t {
  usable,
  few_points,   ///< too few trusted pairs for an estimate
  no_support,   ///< no fundamental matrix fits enough of the trusted pairs: movers in the majority, or bad flow
  no_parallax,  ///< a homography does nearly as well (rotation, small baseline, a plane), so lines mean nothing
};

struct TwoViewOptions {
  double threshold = 0.0029;     ///< distance from the epipolar line
  double parallax = 0.0013;      ///< distance from the homography's transfer
  double parallax_share = 0.35;  ///< of the supporting pairs that must have parallax
  double support = 0.5;          ///< of the trusted pairs that must lie on their lines
  int iterations = 500;          ///< at most
  double confidence = 0.9999;
};

/// The fundamental matrix of the trusted pairs and whether it can be believed. RANSAC with eight-point samples (solved
/// exactly) and least squares over the supporting pairs, then a homography the same way from the same pairs. Reuses
/// its buffers; the same pairs and generator give the same result. One thread.
class TwoViews {
 public:
  explicit TwoViews(const TwoViewOptions& options) : options_(options) {}

  /// distance2() and fundamental() hold for all pairs, trusted or not, when the verdict is `usable`.
  Verdict estimate(const PointPairs& pairs, Random& random);

  const Eigen::Matrix3d& fundamental() const { return fundamental_; }
  const std::vector<float>& distance2() const { return distance2_; }
  /// Of the last estimate: share of the trusted pairs on their lines, share of those with parallax.
  double support() const { return support_; }
  double parallax_share() const { return parallax_share_; }

 private:
  void choose_trusted(const PointPairs& pairs);
  bool find_fundamental(Random& random);
  bool find_homography(Random& random);

  TwoViewOptions options_;
  PointPairs chosen_;  // trusted ones that the estimate uses
  PointPairs supporting_;
  std::vector<float> distance2_, work_;
  Eigen::Matrix3d fundamental_ = Eigen::Matrix3d::Zero(), homography_ = Eigen::Matrix3d::Identity();
  double support_ = 0.0, parallax_share_ = 0.0;
};

}  // namespace holdfast::epipolar_plugin
