// SPDX-License-Identifier: BSD-3-Clause
#include "inertial_consistency.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "holdfast/geometry/se3.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace holdfast::inertial_consistency_plugin {

namespace {

constexpr double nearest_depth = 0.05;  // [m]

/// Derivatives of pixel and right column by the error of PredictedPose.
Eigen::Matrix<double, 3, 6> jacobian_of(const Camera& camera, const Eigen::Vector3d& in_camera) {
  const double x = in_camera.x(), y = in_camera.y(), inverse = 1.0 / in_camera.z();
  Eigen::Matrix3d by_point;
  by_point << camera.fx * inverse, 0.0, -camera.fx * x * inverse * inverse,  //
      0.0, camera.fy * inverse, -camera.fy * y * inverse * inverse,          //
      camera.fx * inverse, 0.0, -camera.fx * (x - camera.baseline) * inverse * inverse;
  // T_world_camera * exp(d) moves the point by -(translation + rotation x point) in the camera frame.
  Eigen::Matrix<double, 3, 6> by_pose;
  by_pose << -Eigen::Matrix3d::Identity(), geometry::hat(in_camera);
  return by_point * by_pose;
}

}  // namespace

std::optional<double> InertialConsistency::innovation(const FilterContext& context, std::size_t i) const {
  const Frame& frame = context.frame;
  const Camera& camera = *frame.camera;
  const PredictedPose& predicted = *context.inertial_prediction;
  const MapPoint* point = context.map.find_point(frame.map_points[i]);
  if (point == nullptr) return std::nullopt;
  const Eigen::Vector3d in_camera = predicted.T_camera_world * point->position;
  if (in_camera.z() < nearest_depth) return std::nullopt;
  const Eigen::Matrix<double, 3, 6> jacobian = jacobian_of(camera, in_camera);
  Eigen::Matrix3d covariance =
      settings_.inflation * settings_.inflation * jacobian * predicted.covariance * jacobian.transpose();
  if (covariance.diagonal().head<2>().maxCoeff() > settings_.largest_deviation * settings_.largest_deviation)
    return std::nullopt;
  covariance.diagonal().array() +=
      settings_.pixel_deviation * settings_.pixel_deviation / frame.pyramid->inverse_sigma2[frame.features.octave[i]];
  const Eigen::Vector2d pixel = camera.project(in_camera);
  Eigen::Vector3d error(frame.x[i] - pixel.x(), frame.y[i] - pixel.y(), 0.0);
  if (!frame.has_depth(i)) {
    const Eigen::Vector2d in_image = error.head<2>();
    return in_image.dot(covariance.topLeftCorner<2, 2>().ldlt().solve(in_image)) / settings_.threshold;
  }
  error.z() = frame.right_x[i] - camera.right_x(pixel.x(), in_camera.z());
  return error.dot(covariance.ldlt().solve(error)) / settings_.threshold_depth;
}

void InertialConsistency::apply(const FilterContext& context, StaticEvidence& evidence) {
  if (context.inertial_prediction == nullptr) return;
  judged_.clear();
  int consistent = 0;
  for (std::size_t i = 0; i < context.frame.size(); ++i) {
    const std::optional<double> error = innovation(context, i);
    if (!error) continue;
    judged_.push_back({i, *error});
    consistent += *error <= 1.0 ? 1 : 0;
  }
  if (consistent < settings_.minimum_consistent) return;
  for (const Judged& judged : judged_) {
    const double certainty = 0.25 + 0.75 * std::min(1.0, (judged.error - 1.0) / 3.0);
    const double said = judged.error <= 1.0 ? settings_.static_log_odds : settings_.moving_log_odds * certainty;
    if (said != 0.0) evidence.add(judged.feature, static_cast<float>(said));
  }
}

}  // namespace holdfast::inertial_consistency_plugin

HOLDFAST_PLUGIN(inertial_consistency, registry) {
  registry.add<holdfast::DynamicFilter, holdfast::inertial_consistency_plugin::InertialConsistency,
               holdfast::InertialConsistencySettings>(
      {.name = holdfast::InertialConsistencySettings::module,
       .summary =
           "What contradicts the motion that inertial measurements predict moves; silent where these cannot tell.",
       .paper = "Bar-Shalom, Li and Kirubarajan: Estimation with Applications to Tracking and Navigation, 2001, "
                "section 5.4"});
}
