// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>
#include <ceres/evaluation_callback.h>

#include <vector>

#include "holdfast/interfaces/bundle_factors.hpp"
#include "observation_cost.hpp"

namespace holdfast::ceres_plugin {

/// The states of the factors as the solver moves them: motions and the world are its parameters themselves, and poses
/// those of PoseState.
struct FactorParameters {
  std::vector<Eigen::Matrix<double, 9, 1>> motions;
  Eigen::Vector3d world = Eigen::Vector3d::Zero();
  FactorEvaluation::States states;  ///< what the residuals see

  /// Without factors there are no states to be kept up to date.
  void update(const std::vector<PoseState>& poses) {
    for (std::size_t i = 0; i < states.poses.size(); ++i) states.poses[i] = poses[i].exact();
    states.motions = motions;
    states.world = world;
  }
};

/// Brings the derived parts of the free poses, and the states of the factors, up to date before each evaluation.
class StateUpdater final : public ceres::EvaluationCallback {
 public:
  StateUpdater(std::vector<PoseState>& poses, FactorParameters& factors) : poses_(poses), factors_(factors) {}
  void PrepareForEvaluation(bool, bool new_evaluation_point) override {
    if (!new_evaluation_point) return;
    for (PoseState& pose : poses_) pose.update();
    factors_.update(poses_);
  }

 private:
  std::vector<PoseState>& poses_;
  FactorParameters& factors_;
};

/// A factor of FactorEvaluation. Blocks: its free poses (6 each), its free motions (9 each), and the world (3) if one
/// of its numbers is free.
class FactorCost final : public ceres::CostFunction {
 public:
  /// `free`: which blocks exist; poses, motions, world.
  using Free = std::array<bool, 5>;
  FactorCost(const FactorEvaluation& evaluation, const FactorEvaluation::Factor& factor,
             const FactorEvaluation::States& states, const std::vector<PoseState>& poses, const Free& free)
      : evaluation_(evaluation), factor_(factor), states_(states), poses_(poses), free_(free) {
    set_num_residuals(factor.rows);
    for (std::size_t i = 0; i < free.size(); ++i)
      if (free[i]) mutable_parameter_block_sizes()->push_back(i < 2 ? 6 : i < 4 ? 9 : 3);
  }

  bool Evaluate(const double* const*, double* residual, double** jacobians) const override {
    FactorError error;
    evaluation_.evaluate(factor_, states_, jacobians != nullptr, error);
    Eigen::VectorXd::Map(residual, factor_.rows) = error.residual.head(factor_.rows);
    if (jacobians == nullptr) return true;
    std::size_t block = 0;
    for (std::size_t i = 0; i < free_.size(); ++i)
      if (free_[i]) write(error, i, jacobians[block++]);
    return true;
  }

 private:
  void write(const FactorError& error, std::size_t block, double* jacobian) const {
    if (jacobian == nullptr) return;
    const Eigen::Index rows = factor_.rows;
    const auto put = [&]<int columns>(const Eigen::Matrix<double, 15, columns>& from) {
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, columns, Eigen::RowMajor>>(jacobian, rows, columns) =
          from.topRows(rows);
    };
    if (block < 2)
      put(by_parameters(error.by_pose[block], poses_[factor_.poses[block]]));
    else if (block < 4)
      put(error.by_motion[block - 2]);
    else
      put(by_free_world(error.by_world));
  }
  /// From a left perturbation to translation and rotation vector: the translation of a left perturbation is that of the
  /// parameters minus the share of the rotation.
  static Eigen::Matrix<double, 15, 6> by_parameters(const Eigen::Matrix<double, 15, 6>& by_pose,
                                                    const PoseState& pose) {
    Eigen::Matrix<double, 15, 6> result = by_pose;
    result.rightCols<3>() =
        (by_pose.rightCols<3>() + by_pose.leftCols<3>() * geometry::hat(pose.translation)) * pose.left_jacobian;
    return result;
  }
  /// Numbers that are fixed have no derivative, so that they do not move.
  Eigen::Matrix<double, 15, 3> by_free_world(Eigen::Matrix<double, 15, 3> by_world) const {
    const std::array<bool, 3> moves = evaluation_.world_moves();
    for (int i = 0; i < 3; ++i)
      if (!moves[static_cast<std::size_t>(i)]) by_world.col(i).setZero();
    return by_world;
  }

  const FactorEvaluation& evaluation_;
  const FactorEvaluation::Factor& factor_;
  const FactorEvaluation::States& states_;
  const std::vector<PoseState>& poses_;
  const Free free_;
};

}  // namespace holdfast::ceres_plugin
