// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "holdfast/depth_blocks/depth_view.hpp"

namespace holdfast::motion_objects_plugin {

using depth_blocks::BlockGrid;
using depth_blocks::DepthNoise;
using depth_blocks::DepthView;

/// The motion of an object between two frames: p_then = centre + translation + rotation * (p_now - centre).
struct RigidMotion {
  Eigen::Vector3f translation = Eigen::Vector3f::Zero();  ///< of the centre [m]
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
};

/// The surface of an object in the current frame, ego-motion-compensated.
struct ObjectPoints {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  std::vector<Eigen::Vector3f>
      points;               ///< positions in the earlier camera frame under the assumption that they are static
  std::vector<float> grey;  ///< brightness of each
};

struct AlignmentResult {
  RigidMotion motion;
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();           ///< of the translation [m^2]
  Eigen::Matrix3f rotation_covariance = Eigen::Matrix3f::Zero();  ///< [rad^2]
  int inliers = 0;                                                ///< points whose depth agrees with the earlier view
};

/// Estimates the rigid motion that aligns the points of an object with an earlier view by minimising the energy of
/// Co-Fusion, E_icp + lambda E_rgb (Ruenz and Agapito 2017, section on tracking): squared point-to-plane distances and
/// squared brightness differences at the projected pixels. Gauss-Newton with Cauchy weights, because objects may be
/// non-rigid. Distances are measured along the ray and weighted by the depth noise.
class RigidAlignment {
 public:
  /// Prior of the motion; it determines directions that the surface does not constrain.
  struct Prior {
    Eigen::Vector3f translation = Eigen::Vector3f::Zero();
    Eigen::Vector3f deviation = Eigen::Vector3f::Ones();  ///< along the camera axes [m]
    float rotation_deviation = 0.1F;                      ///< about no rotation [rad]
  };

  RigidAlignment(const BlockGrid& grid, const DepthNoise& noise) : grid_(grid), noise_(noise) {}

  /// The blocks of an earlier view that belong to the track `track_id`; `owner` holds the track id of every block.
  struct OwnedBlocks {
    const std::vector<std::uint32_t>& owner;
    std::uint32_t track_id;
  };

  /// Aligns with the blocks of `then` that are owned. The optimization starts at `start`. The result is the prior if no
  /// surface is visible.
  AlignmentResult align(const ObjectPoints& now, const DepthView& then, const OwnedBlocks& owned,
                        const RigidMotion& start, const Prior& prior) const;

 private:
  using Vector6f = Eigen::Matrix<float, 6, 1>;
  using Matrix6f = Eigen::Matrix<float, 6, 6>;

  /// Gauss-Newton system of one iteration: lower triangle of the Hessian, negative gradient, points that count.
  struct NormalEquations {
    Matrix6f H = Matrix6f::Zero();
    Vector6f g = Vector6f::Zero();
    int inliers = 0;
  };
  NormalEquations linearise(const ObjectPoints& now, const DepthView& then, const OwnedBlocks& owned,
                            const RigidMotion& motion, float scale) const;
  static void add_prior(const Prior& prior, const RigidMotion& motion, NormalEquations& equations);

  const BlockGrid& grid_;
  DepthNoise noise_;
};

}  // namespace holdfast::motion_objects_plugin
