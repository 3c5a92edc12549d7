// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "holdfast/geometry/preintegration.hpp"
#include "holdfast/geometry/se3.hpp"

namespace holdfast {

/// Kinds of factors of a bundle adjustment besides observations; see Optimizer::supports().
enum class FactorKind { inertial, relative_pose, prior };

/// What a bundle adjustment has besides poses, points and observations: the states of a body with an IMU, and factors,
/// each with half the squared residual, weighted by its information, as its cost. Poses are indices into
/// BundleProblem::poses. Empty in a visual problem. Measured depth needs no factor: it is the column `right_x` of its
/// observation, with the deviation of a disparity.
///
/// The body stands at T_world_camera * T_camera_body, with the translation of T_world_camera multiplied by `scale`.
/// Rotations and translations of a pose are perturbed from the left, exp(d) * T_camera_world, d = (translation [m],
/// rotation [rad]).
struct BundleFactors {
  /// Velocity of the body at a pose, and the biases of its IMU; nine numbers in the order of geometry::inertial.
  struct Motion {
    std::uint32_t pose = 0;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< in the world frame [m/s]; in and out
    ImuBias bias;                                        ///< in and out
    bool fixed = false;
  };
  /// Preintegrated measurements from one motion to another (indices into `motions`), with the random walk of the biases
  /// (Forster et al. 2017, equations 45 to 48). Information: the inverse of its covariance.
  struct Inertial {
    std::uint32_t first = 0, second = 0;
    geometry::Preintegration measured;
  };
  /// Relative pose, with geometry::relative_pose_residual() as its residual.
  struct RelativePose {
    std::uint32_t from = 0, to = 0;
    Eigen::Isometry3d T_to_from = Eigen::Isometry3d::Identity();
    geometry::Matrix6d information = geometry::Matrix6d::Identity();
  };
  /// Prior of a pose; residual: log(T_camera_world * prior^-1).
  struct PosePrior {
    std::uint32_t pose = 0;
    Eigen::Isometry3d T_camera_world = Eigen::Isometry3d::Identity();
    geometry::Matrix6d information = geometry::Matrix6d::Identity();
  };
  /// Prior of a motion (index into `motions`); residual: the difference.
  struct MotionPrior {
    using Information = Eigen::Matrix<double, 9, 9>;
    std::uint32_t motion = 0;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    ImuBias bias;
    Information information = Information::Identity();
  };

  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  /// Acceleration in the world frame, points down [m/s^2]; in and out: its direction, unless it is fixed.
  Eigen::Vector3d gravity{0.0, 0.0, -standard_gravity};
  bool gravity_fixed = false;
  double scale = 1.0;  ///< metres in a unit of the map; in and out, unless it is fixed
  bool scale_fixed = true;
  std::vector<Motion> motions;
  std::vector<Inertial> inertial;
  std::vector<RelativePose> relative_poses;
  std::vector<PosePrior> pose_priors;
  std::vector<MotionPrior> motion_priors;

  bool empty() const {
    return inertial.empty() && relative_poses.empty() && pose_priors.empty() && motion_priors.empty();
  }
};

struct BundleProblem;

/// Whitened residual of a factor, and its derivatives: by left perturbations of its poses, by its motions, and by the
/// world: two tilts of gravity [rad] and the logarithm of the scale. Only the first `rows` rows count, and the blocks
/// of states that the factor has.
struct FactorError {
  int rows = 0;
  geometry::Vector15d residual;
  std::array<Eigen::Matrix<double, 15, 6>, 2> by_pose;
  std::array<Eigen::Matrix<double, 15, 9>, 2> by_motion;
  Eigen::Matrix<double, 15, 3> by_world;
};

/// The factors of a problem as optimizers evaluate them: all kinds alike, with their states as numbers. Shared by all
/// optimizers. A factor counts if one of its states is free.
class FactorEvaluation {
 public:
  static constexpr std::uint32_t none = static_cast<std::uint32_t>(-1);
  /// States of a factor; `none` for those it does not have.
  struct Factor {
    FactorKind kind = FactorKind::prior;
    std::uint32_t index = 0;  ///< in the list of its kind; motion priors follow pose priors
    std::array<std::uint32_t, 2> poses{none, none};
    std::array<std::uint32_t, 2> motions{none, none};
    bool has_world = false;
    int rows = 0;
    Eigen::Matrix<double, 15, 15> root;  ///< the information is root^T * root
  };
  /// States at which factors are evaluated. `motions`: velocity, bias of gyroscope, bias of accelerometer. `world`: two
  /// tilts and the change of the logarithm of the scale since the problem, all 0 at first.
  struct States {
    std::vector<Eigen::Isometry3d> poses;
    std::vector<Eigen::Matrix<double, 9, 1>> motions;
    Eigen::Vector3d world = Eigen::Vector3d::Zero();
  };

  /// Refers to the problem, which must outlive this object. Throws CheckError for an index out of range.
  explicit FactorEvaluation(const BundleProblem& problem);

  /// False if a number is not finite, or an information matrix is not positive: the problem is not usable.
  bool is_finite() const { return is_finite_; }
  const std::vector<Factor>& factors() const { return factors_; }
  /// Whether a motion is free and belongs to a factor.
  bool motion_moves(std::size_t motion) const { return motion_moves_[motion] != 0; }
  /// Whether the three numbers of the world are free.
  std::array<bool, 3> world_moves() const;
  States states() const;
  Eigen::Vector3d gravity_at(const Eigen::Vector3d& world) const;
  double scale_at(const Eigen::Vector3d& world) const;

  /// The whitened residual, and with `with_derivatives` the derivatives.
  void evaluate(const Factor& factor, const States& states, bool with_derivatives, FactorError& error) const;
  /// Half the sum of the squared whitened residuals.
  double cost(const States& states) const;
  /// Writes motions, gravity and scale to the problem.
  void write(const States& states, BundleProblem& problem) const;

 private:
  void add_inertial(std::uint32_t index);
  void add_relative_pose(std::uint32_t index);
  void add_pose_prior(std::uint32_t index);
  void add_motion_prior(std::uint32_t index);
  void add(Factor factor, const Eigen::MatrixXd& root);
  void check_states();
  void evaluate_inertial(const Factor& factor, const States& states, bool with_derivatives, FactorError& error) const;
  void derive_inertial(const Factor& factor, const States& states, const geometry::InertialJacobians& jacobians,
                       FactorError& error) const;
  Eigen::Matrix<double, 3, 2> tilts_at(const Eigen::Vector3d& world) const;

  const BundleProblem& problem_;
  const BundleFactors& given_;
  std::vector<Factor> factors_;
  std::vector<std::uint8_t> motion_moves_;
  Eigen::Matrix<double, 3, 2> tangent_;  // of gravity
  bool is_finite_ = true;
};

}  // namespace holdfast
