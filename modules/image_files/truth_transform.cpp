// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/truth_transform.hpp"

#include <Eigen/SVD>
#include <algorithm>

#include "holdfast/core/error.hpp"
#include "holdfast/core/folder_name.hpp"
#include "holdfast/core/text_file.hpp"

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

std::optional<TruthTransform> known_truth_transform(const std::string& folder, const Camera& camera) {
  const Camera bonn = find_camera("bonn").value();
  const bool is_bonn_camera =
      camera.fx == bonn.fx && camera.fy == bonn.fy && camera.cx == bonn.cx && camera.cy == bonn.cy;
  if (!folder.starts_with("rgbd_bonn_") && !is_bonn_camera) return std::nullopt;
  // https://www.ipb.uni-bonn.de/data/rgbd-dynamic-dataset: T_world_camera = T_ROS T T_ROS T_m.
  static const RealTable left = {{-1, 0, 0, 0}, {0, 0, 1, 0}, {0, 1, 0, 0}, {0, 0, 0, 1}};
  static const RealTable right = {{-1.0157, -0.1828, 0.2389, -0.0113},
                                  {-0.3009, 0.6147, -0.8085, 0.0111},
                                  {0.0009, -0.8431, -0.6413, -0.0098},
                                  {0, 0, 0, 1}};
  return make_truth_transform(left, right, "Bonn RGB-D Dynamic");
}

TruthTransform choose_truth_transform(const TruthChoice& choice, const std::filesystem::path& truth,
                                      const Camera& camera) {
  if (choice.is_raw) return {};
  const TruthTransform given = make_truth_transform(choice.left, choice.right, choice.place);
  if (!choice.left.empty() || !choice.right.empty()) return given;
  const std::optional<TruthTransform> known = known_truth_transform(folder_name(truth.parent_path()), camera);
  if (!known || !why_unreadable(truth, largest_file::text).empty()) return {};
  // What Holdfast wrote is the truth of the camera already.
  LineReader lines(truth, "a trajectory in TUM format");
  std::string first;
  const bool is_ours = lines.next(first) && first + '\n' == trajectory_header;
  return is_ours ? TruthTransform() : *known;
}

Trajectory transformed(const TruthTransform& transform, Trajectory truth) {
  if (transform.is_identity()) return truth;
  for (TimedPose& pose : truth) pose.T_world_camera = transform.left * pose.T_world_camera * transform.right;
  return truth;
}

}  // namespace holdfast
