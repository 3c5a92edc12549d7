// SPDX-License-Identifier: BSD-3-Clause
#include <atomic>
#include <limits>

#include "bad/faulty.hpp"
#include "holdfast/interfaces/optimizer.hpp"

extern "C" void holdfast_register_plugin_ceres(holdfast::Registry&);

namespace holdfast::bad {

namespace {

std::atomic<int> calls = 0;

class FaultyOptimizer final : public Optimizer {
 public:
  FaultyOptimizer(std::string fault, const CreationContext& context)
      : fault_(std::move(fault)), ceres_(sound_module<Optimizer>(holdfast_register_plugin_ceres, "ceres", context)) {}

  PoseSummary optimize_pose(PoseProblem& problem) override {
    const auto inlier = problem.inlier;
    if (fault_ == "ignores_weights") problem.weight.assign(problem.size(), 1.0F);
    PoseSummary summary = ceres_->optimize_pose(problem);
    if (fault_ == "forgets_inliers") problem.inlier = inlier;
    if (fault_ == "miscounts") summary.inliers += 1;
    if (fault_ == "moves_unusable" && !summary.usable) problem.T_camera_world.translation().x() += 1.0;
    if (fault_ == "no_number") problem.T_camera_world.translation().x() = std::numeric_limits<double>::quiet_NaN();
    if (fault_ == "rounds_rotations") problem.T_camera_world.linear() *= 1.001;
    if (fault_ == "counts_calls") problem.T_camera_world.translation().x() += 1e-9 * ++calls;
    if (fault_ == "no_covariance") summary.covariance.setZero();
    return summary;
  }

  bool supports(FactorKind kind) const override { return fault_ != "denies_factors" && ceres_->supports(kind); }

  BundleSummary optimize_bundle(BundleProblem& problem, const std::atomic<bool>& stop) override {
    const std::atomic<bool> go_on = false;
    if (fault_ == "ignores_factors") problem.factors.inertial.clear();
    BundleSummary summary = ceres_->optimize_bundle(problem, fault_ == "never_stops" ? go_on : stop);
    if (fault_ == "miscounts") summary.outliers += 1;
    if (fault_ == "moves_fixed" && !problem.poses.empty()) problem.poses[0].T_camera_world.translation().x() += 1e-6;
    return summary;
  }

  GraphSummary optimize_pose_graph(PoseGraphProblem& problem) override {
    if (fault_ == "tilts") problem.vertical.reset();
    GraphSummary summary = ceres_->optimize_pose_graph(problem);
    if (fault_ == "stays_away" && problem.nodes.size() > 3) problem.nodes[3].T_camera_world.translation().y() += 0.1;
    return summary;
  }

  bool keeps_vertical() const override { return ceres_->keeps_vertical(); }

 private:
  std::string fault_;
  std::unique_ptr<Optimizer> ceres_;
};

}  // namespace

void add_optimizers(Registry& registry) {
  add_faults<Optimizer, FaultyOptimizer>(
      registry, {"sound", "ignores_weights", "forgets_inliers", "miscounts", "moves_unusable", "no_number",
                 "rounds_rotations", "counts_calls", "no_covariance", "never_stops", "moves_fixed", "stays_away",
                 "denies_factors", "ignores_factors", "tilts"});
}

}  // namespace holdfast::bad
