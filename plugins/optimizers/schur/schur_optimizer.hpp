// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "bundle_adjustment.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/settings/schur.hpp"

namespace holdfast::schur_plugin {

/// The optimizer with solvers of its own; single poses go to geometry::adjust_pose. Every problem is solved on the
/// calling thread. The memory of a bundle adjustment is kept for the next one.
class SchurOptimizer final : public Optimizer {
 public:
  SchurOptimizer(const SchurSettings& settings, const CreationContext& context);

  PoseSummary optimize_pose(PoseProblem& problem) override;
  bool supports(FactorKind) const override { return true; }
  BundleSummary optimize_bundle(BundleProblem& problem, const std::atomic<bool>& stop) override;
  GraphSummary optimize_pose_graph(PoseGraphProblem& problem) override;
  bool keeps_vertical() const override { return true; }

 private:
  SchurSettings settings_;
  std::mutex mutex_;                                   // of idle_
  std::vector<std::unique_ptr<BundleAdjuster>> idle_;  // adjusters that no thread uses now
};

}  // namespace holdfast::schur_plugin
