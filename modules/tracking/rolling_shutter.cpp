// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/rolling_shutter.hpp"

#include <algorithm>
#include <cmath>

#include "holdfast/matching/frame_features.hpp"

namespace holdfast {

namespace {

/// From the exposure of the middle row to that of a feature, as a share of the readout time.
double share_of(const Frame& frame, std::size_t feature) {
  return static_cast<double>(frame.features.y[feature]) / frame.camera->height - 0.5;
}

/// Velocity, in the camera frame, of a static point at X in it, before a camera that moves [m/s].
Eigen::Vector3d velocity_of(const FrameMotion& motion, const Eigen::Vector3d& X) {
  return (motion.tangent.head<3>() + motion.tangent.tail<3>().cross(X)) / motion.interval;
}

// What the frames of a third of a second of a hand-held recording add up to, and those of two seconds.
constexpr double initial_information = 3e6, remembered_information = 1.5e7;

}  // namespace

RollingShutter::RollingShutter(RollingShutterMode mode, double readout)
    : mode_(mode), readout_(readout), information_(initial_information) {}

void RollingShutter::correct(const FrameMotion& motion, const Map& map, Frame& frame) const {
  constexpr double typical_depth = 2.0, min_depth = 0.05;  // m
  const Camera& camera = *frame.camera;
  const Eigen::Vector3d rotation = motion.tangent.tail<3>() / motion.interval;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    double depth = frame.depth[i];
    if (!frame.has_depth(i)) {
      const MapPoint* point = map.find_point(frame.map_points[i]);
      depth = point != nullptr ? (frame.T_camera_world * point->position).z() : typical_depth;
      if (!(depth > min_depth)) depth = typical_depth;
    }
    const double t = share_of(frame, i) * readout_;
    const Eigen::Vector3d X = camera.back_project(frame.x[i], frame.y[i], depth);
    const Eigen::Vector3d velocity = velocity_of(motion, X);
    const Eigen::Vector3d corrected = X - t * velocity + 0.5 * t * t * rotation.cross(velocity);
    if (!(corrected.z() > min_depth)) continue;
    const Eigen::Vector2d pixel = camera.project(corrected);
    frame.x[i] = static_cast<float>(pixel.x());
    frame.y[i] = static_cast<float>(pixel.y());
    if (!frame.has_depth(i)) continue;
    frame.depth[i] = static_cast<float>(corrected.z());
    frame.right_x[i] = static_cast<float>(camera.right_x(pixel.x(), corrected.z()));
  }
}

void RollingShutter::learn(const FrameMotion& motion, const Map& map, const Frame& frame) {
  if (!is_estimated()) return;
  constexpr int minimum_points = 50;
  constexpr double min_depth = 0.05;  // m
  constexpr double enlargement = 4.0;
  constexpr double largest_share = 0.5;  // of the step by one frame: a map may be better than most
  constexpr double longest = 0.1;        // s
  const Camera& camera = *frame.camera;
  Eigen::Matrix<double, 7, 7> normal = Eigen::Matrix<double, 7, 7>::Zero();  // pose, readout
  Eigen::Matrix<double, 7, 1> gradient = Eigen::Matrix<double, 7, 1>::Zero();
  int points = 0;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const MapPoint* point = map.find_point(frame.map_points[i]);
    if (point == nullptr || !is_static(frame, i)) continue;
    const Eigen::Vector3d X = frame.T_camera_world * point->position;
    if (!(X.z() > min_depth)) continue;
    const double weight = frame.pyramid->inverse_scale[frame.features.octave[i]];  // of a feature's accuracy
    const Eigen::Vector2d residual = weight * (Eigen::Vector2d(frame.x[i], frame.y[i]) - camera.project(X));
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << camera.fx, 0.0, -camera.fx * X.x() / X.z(), 0.0, camera.fy, -camera.fy * X.y() / X.z();
    by_point *= weight / X.z();
    Eigen::Matrix<double, 2, 7> jacobian;
    jacobian.leftCols<3>() = -by_point;
    jacobian.middleCols<3>(3) = by_point * geometry::hat(X);
    jacobian.col(6) = -share_of(frame, i) * (by_point * velocity_of(motion, X));
    normal.noalias() += jacobian.transpose() * jacobian;
    gradient.noalias() += jacobian.transpose() * residual;
    ++points;
  }
  if (points < minimum_points) return;
  const Eigen::Matrix<double, 6, 1> eliminated =
      normal.topLeftCorner<6, 6>().ldlt().solve(normal.topRightCorner<6, 1>());
  const double information = normal(6, 6) - normal.topRightCorner<6, 1>().dot(eliminated);
  const double step = -(gradient(6) - eliminated.dot(gradient.head<6>())) / information;
  if (!std::isfinite(step) || !(information > 0.0)) return;
  information_ = std::min(information_ + information, remembered_information);
  const double share = std::min(enlargement * information / information_, largest_share);
  readout_ = std::clamp(readout_ + share * step, -longest, longest);
}

}  // namespace holdfast
