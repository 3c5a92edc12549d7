// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/geometry/two_view_certainty.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/synthetic.hpp"

namespace holdfast::geometry {
namespace {

struct Views {
  Camera camera = synthetic::camera();
  Eigen::Isometry3d T_b_a = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Vector3d> points;  // in camera a
  std::vector<PixelPair> pairs;

  /// Points at 1 to 3 m in a part of the image around its centre.
  Views(int count, double share_of_image, std::uint64_t seed) {
    T_b_a.linear() = exp_so3(Eigen::Vector3d(0.01, -0.02, 0.015)).toRotationMatrix();
    T_b_a.translation() = Eigen::Vector3d(0.15, 0.02, 0.05);
    Random random(seed);
    for (int i = 0; i < count; ++i) {
      const double x = 320 + share_of_image * random.uniform(-300, 300);
      const double y = 240 + share_of_image * random.uniform(-220, 220);
      points.push_back(camera.back_project(x, y, random.uniform(1, 3)));
      pairs.push_back({camera.project(points.back()), camera.project(T_b_a * points.back()), 1.0, 2.0});
    }
  }
  double deviation() const { return direction_deviation(camera, pairs, T_b_a); }
};

/// The same from the normal equations of an adjustment of motion and points together, by numeric derivatives.
double deviation_of_adjustment(const Views& views) {
  const auto points = static_cast<Eigen::Index>(views.points.size());
  const Eigen::Vector3d direction = views.T_b_a.translation().normalized();
  const Eigen::Vector3d first = direction.unitOrthogonal(), second = direction.cross(first);
  const double length = views.T_b_a.translation().norm();
  const auto residuals = [&](const Eigen::VectorXd& change) {
    Eigen::Isometry3d T_b_a = views.T_b_a;
    T_b_a.linear() = exp_so3(Eigen::Vector3d(change.head<3>())) * views.T_b_a.linear();
    T_b_a.translation() = length * (direction + change[3] * first + change[4] * second).normalized();
    Eigen::VectorXd result(4 * points);
    for (Eigen::Index i = 0; i < points; ++i) {
      const auto& pair = views.pairs[static_cast<std::size_t>(i)];
      const Eigen::Vector3d point = views.points[static_cast<std::size_t>(i)] + change.segment<3>(5 + 3 * i);
      result.segment<2>(4 * i) = (views.camera.project(point) - pair.a) / std::sqrt(pair.sigma2_a);
      result.segment<2>(4 * i + 2) = (views.camera.project(T_b_a * point) - pair.b) / std::sqrt(pair.sigma2_b);
    }
    return result;
  };
  const Eigen::Index size = 5 + 3 * points;
  Eigen::MatrixXd jacobian(4 * points, size);
  constexpr double step = 1e-6;
  for (Eigen::Index k = 0; k < size; ++k) {
    Eigen::VectorXd change = Eigen::VectorXd::Zero(size);
    change[k] = step;
    jacobian.col(k) = (residuals(change) - residuals(-change)) / (2 * step);
  }
  const Eigen::MatrixXd covariance = (jacobian.transpose() * jacobian).inverse();
  return std::sqrt(covariance(3, 3) + covariance(4, 4));
}

TEST(DirectionDeviation, IsThatOfAnAdjustmentOfMotionAndPoints) {
  for (const double share : {1.0, 0.4}) {
    const Views views(40, share, 3);
    EXPECT_NEAR(views.deviation(), deviation_of_adjustment(views), 0.02 * views.deviation()) << share;
  }
}

TEST(DirectionDeviation, GrowsWhereThePairsCoverLittleOfTheImage) {
  const double wide = Views(200, 1.0, 5).deviation(), narrow = Views(200, 0.2, 5).deviation();
  EXPECT_LT(wide, 0.02);
  EXPECT_GT(narrow, 4 * wide);
}

TEST(DirectionDeviation, OfWhatDeterminesNothingIsInfinite) {
  EXPECT_TRUE(std::isinf(Views(4, 1.0, 1).deviation()));
  Views turned(100, 1.0, 1);
  turned.T_b_a.translation().setZero();
  EXPECT_TRUE(std::isinf(turned.deviation()));
}

}  // namespace
}  // namespace holdfast::geometry
