// SPDX-License-Identifier: BSD-3-Clause
#include "ceres_optimizer.hpp"

#include <glog/logging.h>

#include <mutex>

#include "bundle_adjustment.hpp"
#include "holdfast/interfaces/pose_adjustment_settings.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "pose_graph.hpp"

namespace holdfast::ceres_plugin {

CeresOptimizer::CeresOptimizer(const CeresSettings& settings, const CreationContext&) : settings_(settings) {
  // Ceres warns through glog, which writes to stderr until somebody initialises it. Whoever does so keeps their levels.
  // Once, because the level belongs to the process, and other threads may make optimizers, and log, at the same time.
  static std::once_flag is_silenced;
  std::call_once(is_silenced, [] {
    if (!google::IsGoogleLoggingInitialized()) FLAGS_minloglevel = google::GLOG_FATAL;
  });
}

PoseSummary CeresOptimizer::optimize_pose(PoseProblem& problem) {
  return geometry::adjust_pose(problem, pose_adjustment_options(settings_));
}

BundleSummary CeresOptimizer::optimize_bundle(BundleProblem& problem, const std::atomic<bool>& stop) {
  return adjust_bundle(problem, stop, settings_);
}

GraphSummary CeresOptimizer::optimize_pose_graph(PoseGraphProblem& problem) {
  return adjust_pose_graph(problem, settings_);
}

}  // namespace holdfast::ceres_plugin

HOLDFAST_PLUGIN(ceres, registry) {
  using namespace holdfast;
  registry.add<Optimizer, ceres_plugin::CeresOptimizer, CeresSettings>(
      {.name = CeresSettings::module,
       .summary =
           "Bundle adjustment and pose graphs with Ceres Solver; motion-only adjustment with a fixed-size solver.",
       .paper = "Mur-Artal and Tardos, ORB-SLAM2, IEEE Transactions on Robotics 33(5), 2017; Agarwal, Mierle et al., "
                "Ceres Solver"});
}
