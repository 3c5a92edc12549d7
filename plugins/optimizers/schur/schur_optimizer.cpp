// SPDX-License-Identifier: BSD-3-Clause
#include "schur_optimizer.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "holdfast/interfaces/pose_adjustment_settings.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "pose_graph.hpp"

namespace holdfast::schur_plugin {

SchurOptimizer::SchurOptimizer(const SchurSettings& settings, const CreationContext&) : settings_(settings) {}

PoseSummary SchurOptimizer::optimize_pose(PoseProblem& problem) {
  return geometry::adjust_pose(problem, pose_adjustment_options(settings_));
}

BundleSummary SchurOptimizer::optimize_bundle(BundleProblem& problem, const std::atomic<bool>& stop) {
  std::unique_ptr<BundleAdjuster> adjuster;
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      adjuster = std::move(idle_.back());
      idle_.pop_back();
    }
  }
  if (adjuster == nullptr) adjuster = std::make_unique<BundleAdjuster>(settings_, simd_level());
  const BundleSummary summary = adjuster->run(problem, stop);
  // The memory of a full adjustment is not kept, because the next one is far away. Of poses, the free ones tell it from
  // a local adjustment.
  constexpr std::ptrdiff_t most_free = 64;
  if (std::count_if(problem.poses.begin(), problem.poses.end(), [](const auto& pose) { return !pose.fixed; }) <=
      most_free) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(adjuster));
  }
  return summary;
}

GraphSummary SchurOptimizer::optimize_pose_graph(PoseGraphProblem& problem) {
  return adjust_pose_graph(problem, settings_);
}

}  // namespace holdfast::schur_plugin

HOLDFAST_PLUGIN(schur, registry) {
  using namespace holdfast;
  registry.add<Optimizer, schur_plugin::SchurOptimizer, SchurSettings>(
      {.name = SchurSettings::module,
       .summary = "Bundle adjustment on the Schur complement and pose graphs with vectorised solvers of fixed block "
                  "sizes; motion-only adjustment with a fixed-size solver.",
       .paper = "Triggs et al., Bundle Adjustment: A Modern Synthesis, 2000; Lourakis and Argyros, SBA, ACM "
                "Transactions on Mathematical Software 36(1), 2009; Mur-Artal and Tardos, ORB-SLAM2, IEEE Transactions "
                "on Robotics 33(5), 2017"});
}
