// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <optional>

#include "holdfast/matching/traits.hpp"

namespace holdfast::matching {

/// Conditions under which a view should show a point (Mur-Artal et al. 2015, section V-D).
struct VisibilityGates {
  float min_depth = 0.05F;    ///< minimum depth along the optical axis [m]
  float min_distance = 0.8F;  ///< factor on the point's minimum matching distance
  float max_distance = 1.2F;  ///< factor on its maximum matching distance
  float min_cosine = 0.5F;    ///< minimum cosine of the angle to the mean viewing direction; 0.5 is 60 degrees
};

/// Pixel at which a point is predicted.
struct PredictedPixel {
  float x = 0.0F, y = 0.0F;  ///< undistorted [px]
  float right_x = 0.0F;      ///< column in the right image [px]
};

/// A point that a view should show.
struct ExpectedView {
  PredictedPixel pixel;
  float distance = 0.0F;  ///< from the camera's centre [m]
  float cosine = 0.0F;    ///< of the angle between the line of sight and the mean viewing direction
};

/// Projects points into a view from a given pose. Computes in single precision: the rounding error is about 0.01 px at
/// 100 m from the world's origin.
template <FeatureView View>
class ViewProjection {
 public:
  /// `rotation` and `translation` take points from the world to the camera. The view must outlive the projection.
  ViewProjection(const View& view, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation,
                 const VisibilityGates& gates = {})
      : view_(view), gates_(gates), R_(rotation.cast<float>()), t_(translation.cast<float>()) {
    centre_ = -(R_.transpose() * t_);
    const Pinhole camera = ViewTraits<View>::camera(view);
    fx_ = static_cast<float>(camera.fx), fy_ = static_cast<float>(camera.fy);
    cx_ = static_cast<float>(camera.cx), cy_ = static_cast<float>(camera.cy);
    fx_baseline_ = static_cast<float>(camera.fx * camera.baseline);
  }

  /// Returns nothing for a point behind the camera, too near or outside the image. The position is in the world [m].
  std::optional<PredictedPixel> project(const Eigen::Vector3f& position) const {
    const float px = position.x(), py = position.y(), pz = position.z();
    const float z = R_(2, 0) * px + R_(2, 1) * py + R_(2, 2) * pz + t_.z();
    if (!(z > gates_.min_depth)) return std::nullopt;
    const float inverse_z = 1.0F / z;
    const float x = fx_ * (R_(0, 0) * px + R_(0, 1) * py + R_(0, 2) * pz + t_.x()) * inverse_z + cx_;
    const float y = fy_ * (R_(1, 0) * px + R_(1, 1) * py + R_(1, 2) * pz + t_.y()) * inverse_z + cy_;
    if (!ViewTraits<View>::covers(view_, x, y)) return std::nullopt;
    return PredictedPixel{x, y, x - fx_baseline_ * inverse_z};
  }

  /// Like project(), and also returns nothing for a point outside its distance range or seen at too large an angle to
  /// its mean viewing direction. Distances are those of PointTraits [m].
  std::optional<ExpectedView> expect(const Eigen::Vector3f& position, const Eigen::Vector3f& direction,
                                     float min_distance, float max_distance) const {
    const std::optional<PredictedPixel> pixel = project(position);
    if (!pixel) return std::nullopt;
    const float dx = position.x() - centre_.x(), dy = position.y() - centre_.y(), dz = position.z() - centre_.z();
    const float distance = std::sqrt(dx * dx + dy * dy + dz * dz);
    if (distance < gates_.min_distance * min_distance || distance > gates_.max_distance * max_distance)
      return std::nullopt;
    const float cosine = (dx * direction.x() + dy * direction.y() + dz * direction.z()) / distance;
    if (cosine < gates_.min_cosine) return std::nullopt;
    return ExpectedView{*pixel, distance, cosine};
  }
  template <PointSet Points>
  std::optional<ExpectedView> expect(const Points& points, std::uint32_t i) const {
    using Traits = PointTraits<Points>;
    return expect(Traits::position(points, i), Traits::direction(points, i), Traits::min_distance(points, i),
                  Traits::max_distance(points, i));
  }

 private:
  const View& view_;
  VisibilityGates gates_;
  Eigen::Matrix3f R_;
  Eigen::Vector3f t_, centre_;
  float fx_, fy_, cx_, cy_, fx_baseline_;
};

}  // namespace holdfast::matching
