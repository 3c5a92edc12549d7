// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/settings/ceres.hpp"

namespace holdfast::ceres_plugin {

/// The optimizer on Ceres Solver; single poses go to geometry::adjust_pose. Every problem is solved on the calling
/// thread alone, because with more threads Ceres sums in the order in which they finish.
class CeresOptimizer final : public Optimizer {
 public:
  CeresOptimizer(const CeresSettings& settings, const CreationContext& context);

  PoseSummary optimize_pose(PoseProblem& problem) override;
  bool supports(FactorKind) const override { return true; }
  BundleSummary optimize_bundle(BundleProblem& problem, const std::atomic<bool>& stop) override;
  GraphSummary optimize_pose_graph(PoseGraphProblem& problem) override;
  bool keeps_vertical() const override { return true; }

 private:
  CeresSettings settings_;
};

}  // namespace holdfast::ceres_plugin
