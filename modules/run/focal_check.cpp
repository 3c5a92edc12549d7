// SPDX-License-Identifier: BSD-3-Clause
#include "focal_check.hpp"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "holdfast/geometry/se3.hpp"
#include "holdfast/geometry/so3.hpp"

namespace holdfast {

namespace {

using Vector3 = Eigen::Vector3d;
using Vector7 = Eigen::Matrix<double, 7, 1>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;

/// A point in the image of the nominal camera: x / z, y / z, and its depth [m].
using Measurement = Vector3;

struct Pair {
  std::vector<Measurement> first, second;  // of the same points
  Eigen::Isometry3d T_second_first;
};

constexpr int neighbours_of_keyframe = 5;
constexpr std::size_t fewest_points = 20;  // of a pair
constexpr std::size_t fewest_pairs = 10;
constexpr int iterations = 6;
constexpr double huber_bound = 1.5;  // in standard deviations

/// Standard deviations of the position of a feature [px] and of its depth [m], which grows with the squared depth
/// (Khoshelham and Oude Elberink 2012).
constexpr double pixel_deviation = 1.0;
double depth_deviation(double depth) { return 0.003 + 0.003 * depth * depth; }

Measurement measurement(const KeyFrame& keyframe, std::size_t feature) {
  const Vector3 point = keyframe.frame.camera_point(feature);
  return {point.x() / point.z(), point.y() / point.z(), point.z()};
}

Pair pair_of(const Map& map, KeyFrameId first_id, KeyFrameId second_id) {
  const KeyFrame &first = map.keyframe(first_id), &second = map.keyframe(second_id);
  Pair pair;
  pair.T_second_first = second.frame.T_camera_world * first.frame.T_camera_world.inverse();
  for (std::size_t i = 0; i < first.frame.size(); ++i) {
    const MapPointId id = first.frame.map_points[i];
    if (!id.valid() || !first.frame.has_depth(i)) continue;
    const int there = map.feature_of(id, second_id);
    if (there < 0 || !second.frame.has_depth(static_cast<std::size_t>(there))) continue;
    pair.first.push_back(measurement(first, i));
    pair.second.push_back(measurement(second, static_cast<std::size_t>(there)));
  }
  return pair;
}

std::vector<Pair> pairs_of(const Map& map) {
  std::vector<Pair> pairs;
  for (const KeyFrameId id : map.keyframes_by_age())
    for (const KeyFrameId neighbour : map.best_covisible(id, neighbours_of_keyframe)) {
      Pair pair = pair_of(map, neighbour, id);
      if (pair.first.size() >= fewest_points) pairs.push_back(std::move(pair));
    }
  return pairs;
}

/// Normal equations of a pair in its relative pose (translation, rotation) and the focal ratio.
struct Equations {
  Matrix7 information = Matrix7::Zero();
  Vector7 gradient = Vector7::Zero();
};

void add_point(const Measurement& first, const Measurement& second, const Eigen::Isometry3d& pose, double ratio,
               double focal_length, Equations& equations) {
  const Vector3 point(first.x() * first.z() / ratio, first.y() * first.z() / ratio, first.z());
  const Vector3 moved = pose * point;
  if (moved.z() <= 0.0) return;
  Eigen::Matrix<double, 3, 7> of_moved;
  of_moved.leftCols<3>().setIdentity();
  of_moved.middleCols<3>(3) = -geometry::hat(moved);
  of_moved.col(6) = pose.linear() * Vector3(-point.x() / ratio, -point.y() / ratio, 0.0);
  const Vector3 projected(ratio * moved.x() / moved.z(), ratio * moved.y() / moved.z(), moved.z());
  Eigen::Matrix3d projection = Eigen::Matrix3d::Zero();
  projection.row(0) << ratio / moved.z(), 0.0, -projected.x() / moved.z();
  projection.row(1) << 0.0, ratio / moved.z(), -projected.y() / moved.z();
  projection(2, 2) = 1.0;
  Eigen::Matrix<double, 3, 7> jacobian = projection * of_moved;
  jacobian(0, 6) += moved.x() / moved.z();
  jacobian(1, 6) += moved.y() / moved.z();

  const double depth_noise = std::hypot(depth_deviation(first.z()), depth_deviation(second.z()));
  const Vector3 scale(focal_length / pixel_deviation, focal_length / pixel_deviation, 1.0 / depth_noise);
  const Vector3 error = scale.cwiseProduct(projected - second);
  jacobian = scale.asDiagonal() * jacobian;
  const double norm = error.norm();
  const double weight = norm <= huber_bound ? 1.0 : huber_bound / norm;
  equations.information += weight * jacobian.transpose() * jacobian;
  equations.gradient -= weight * jacobian.transpose() * error;
}

/// Standard deviation of the ratio from the scatter of eight parts of the run, each with a ratio of its own: it counts
/// the errors that a part has in common, such as people who were taken for static.
class PartScatter {
 public:
  explicit PartScatter(std::size_t pairs) : pairs_(pairs) {}
  void add(std::size_t pair, double information, double gradient) {
    const std::size_t part = pair * parts / pairs_;
    information_[part] += information;
    gradient_[part] += gradient;
  }
  double deviation() const {
    double total = 0.0, scatter = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < parts; ++i) total += information_[i], mean += gradient_[i];
    mean /= total;
    for (std::size_t i = 0; i < parts; ++i) {
      const double difference = information_[i] > 0.0 ? gradient_[i] / information_[i] - mean : 0.0;
      scatter += information_[i] * difference * difference;
    }
    return std::sqrt(scatter / ((parts - 1) * total));
  }

 private:
  static constexpr std::size_t parts = 8;
  std::size_t pairs_;
  std::array<double, parts> information_{}, gradient_{};
};

/// The ratio's information after the pose was eliminated, and the pose's step for a step of the ratio.
struct Eliminated {
  double information = 0.0, gradient = 0.0;
  Eigen::LDLT<geometry::Matrix6d> pose;
  geometry::Vector6d coupling, pose_gradient;
};

Eliminated eliminated(const Equations& equations) {
  Eliminated result;
  result.pose.compute(equations.information.topLeftCorner<6, 6>());
  result.coupling = equations.information.topRightCorner<6, 1>();
  result.pose_gradient = equations.gradient.head<6>();
  const geometry::Vector6d solved = result.pose.solve(result.coupling);
  result.information = equations.information(6, 6) - result.coupling.dot(solved);
  result.gradient = equations.gradient(6) - result.pose_gradient.dot(solved);
  return result;
}

}  // namespace

std::optional<FocalRatio> estimate_focal_ratio(const Map& map) {
  std::vector<Pair> pairs = pairs_of(map);
  if (pairs.size() < fewest_pairs) return std::nullopt;
  const Camera& camera = *map.keyframe(map.keyframes_by_age().front()).frame.camera;
  const double focal_length = 0.5 * (camera.fx + camera.fy);
  FocalRatio result;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    double information = 0.0, gradient = 0.0;
    PartScatter scatter(pairs.size());
    std::vector<Eliminated> steps;
    for (const Pair& pair : pairs) {
      Equations equations;
      for (std::size_t i = 0; i < pair.first.size(); ++i)
        add_point(pair.first[i], pair.second[i], pair.T_second_first, result.ratio, focal_length, equations);
      steps.push_back(eliminated(equations));
      information += steps.back().information;
      gradient += steps.back().gradient;
      scatter.add(steps.size() - 1, steps.back().information, steps.back().gradient);
    }
    if (!(information > 0.0)) return std::nullopt;
    const double step = gradient / information;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const geometry::Vector6d motion = steps[i].pose.solve(steps[i].pose_gradient - steps[i].coupling * step);
      pairs[i].T_second_first = geometry::exp_se3(motion) * pairs[i].T_second_first;
    }
    result.ratio += step;
    result.deviation = scatter.deviation();
  }
  return std::isfinite(result.ratio) && result.ratio > 0.0 ? std::optional(result) : std::nullopt;
}

std::string focal_warning(const FocalRatio& focal, const Camera& camera) {
  constexpr double least_error = 0.1, significant = 6.0;
  const double error = std::abs(focal.ratio - 1.0);
  if (error < least_error || error < significant * focal.deviation) return "";
  char text[320];
  std::snprintf(text, sizeof(text),
                "the depth of the same points before and after a turn fits a focal length of %.0f px (deviation %.0f) "
                "better than the %.0f px of `camera`: are its numbers of this camera, at this image size? Calibrate it "
                "(`holdfast calibrate`)",
                focal.ratio * camera.fx, focal.deviation * camera.fx, camera.fx);
  return text;
}

}  // namespace holdfast
