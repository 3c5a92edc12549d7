// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/truth_transform.hpp"

#include <Eigen/SVD>
#include <algorithm>

#include "holdfast/core/error.hpp"

namespace holdfast {

namespace {

constexpr double largest_stretch = 1.25;

Eigen::Isometry3d rigid_motion(const RealTable& rows, const SourceLocation& place) {
  if (rows.empty()) return Eigen::Isometry3d::Identity();
  const auto is_row = [](const std::vector<double>& row) { return row.size() == 4; };
  if (rows.size() != 4 || !std::all_of(rows.begin(), rows.end(), is_row))
    throw InputError(place, "found " + to_string(ParameterValue(rows)) +
                                "; expected the four rows of a 4 x 4 matrix, [[r, r, r, x], [r, r, r, y], [r, r, r, "
                                "z], [0, 0, 0, 1]]");
  if (rows[3] != std::vector<double>{0.0, 0.0, 0.0, 1.0})
    throw InputError(place, "found the last row " + to_string(ParameterValue(rows[3])) +
                                "; expected [0, 0, 0, 1], because poses are rigid motions");
  Eigen::Matrix3d turn;
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column)
      turn(static_cast<int>(row), static_cast<int>(column)) = rows[row][column];
    motion.translation()[static_cast<int>(row)] = rows[row][3];
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(turn, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d stretch = svd.singularValues();
  if (!(stretch.maxCoeff() <= largest_stretch && stretch.minCoeff() >= 1.0 / largest_stretch &&
        turn.determinant() > 0.0))
    throw InputError(place, "found " + to_string(ParameterValue(rows)) +
                                ", whose first three rows and columns are no rotation; expected a rotation matrix; "
                                "correct its numbers and their signs");
  motion.linear() = svd.matrixU() * svd.matrixV().transpose();
  return motion;
}

}  // namespace

bool TruthTransform::is_identity() const {
  return left.matrix() == Eigen::Matrix4d::Identity() && right.matrix() == Eigen::Matrix4d::Identity();
}

TruthTransform make_truth_transform(const RealTable& left, const RealTable& right, const std::string& place) {
  return {rigid_motion(left, {place + ".truth_left"}), rigid_motion(right, {place + ".truth_right"})};
}

Trajectory transformed(const TruthTransform& transform, Trajectory truth) {
  if (transform.is_identity()) return truth;
  for (TimedPose& pose : truth) pose.T_world_camera = transform.left * pose.T_world_camera * transform.right;
  return truth;
}

}  // namespace holdfast
