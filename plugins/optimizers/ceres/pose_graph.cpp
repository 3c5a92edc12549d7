// SPDX-License-Identifier: BSD-3-Clause
#include "pose_graph.hpp"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <array>
#include <cmath>
#include <deque>

#include "holdfast/core/error.hpp"
#include "relative_pose_cost.hpp"

namespace holdfast::ceres_plugin {

GraphSummary adjust_pose_graph(PoseGraphProblem& problem, const CeresSettings& settings) {
  GraphSummary summary;
  std::vector<std::array<double, 7>> blocks(problem.nodes.size());
  bool has_fixed = false;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!problem.nodes[i].T_camera_world.matrix().allFinite()) return summary;
    store(problem.nodes[i].T_camera_world, blocks[i].data());
    has_fixed |= problem.nodes[i].fixed;
  }
  if (!has_fixed) return summary;
  const Eigen::Vector3d vertical = problem.vertical.value_or(Eigen::Vector3d::UnitZ()).normalized();
  if (!(std::abs(vertical.norm() - 1.0) < 1e-6)) return summary;

  LeftPerturbation all_directions;
  UprightPerturbation upright(vertical);
  ceres::Manifold* const manifold =
      problem.vertical ? static_cast<ceres::Manifold*>(&upright) : static_cast<ceres::Manifold*>(&all_directions);
  std::deque<RelativePoseCost> costs;
  std::vector<std::uint8_t> used(blocks.size());
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem ceres_problem(problem_options);
  for (std::size_t i = 0; i < problem.edges.size(); ++i) {
    const PoseGraphProblem::Edge& edge = problem.edges[i];
    HOLDFAST_CHECK(edge.from < blocks.size() && edge.to < blocks.size() && edge.from != edge.to,
                   "edge " << i << " from " << edge.from << " to " << edge.to << " of " << blocks.size() << " nodes");
    if (!edge.T_to_from.matrix().allFinite() || !std::isfinite(edge.weight)) return summary;
    if (edge.weight <= 0.0 || (problem.nodes[edge.from].fixed && problem.nodes[edge.to].fixed)) continue;
    ceres_problem.AddResidualBlock(&costs.emplace_back(edge.T_to_from, std::sqrt(edge.weight)), nullptr,
                                   blocks[edge.from].data(), blocks[edge.to].data());
    used[edge.from] = used[edge.to] = 1;
  }
  if (costs.empty()) return summary;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!used[i]) continue;
    ceres_problem.SetManifold(blocks[i].data(), manifold);
    if (problem.nodes[i].fixed) ceres_problem.SetParameterBlockConstant(blocks[i].data());
  }

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  // CHOLMOD starts threads of its own through OpenMP and BLAS, whatever num_threads says.
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.max_num_iterations = problem.iterations;
  options.function_tolerance = settings.function_tolerance;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary result;
  ceres::Solve(options, &ceres_problem, &result);
  summary.iterations = std::max(0, static_cast<int>(result.iterations.size()) - 1);
  summary.initial_cost = result.initial_cost;
  summary.final_cost = result.final_cost;
  if (!result.IsSolutionUsable() || !std::isfinite(result.final_cost)) return summary;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    if (used[i] && !problem.nodes[i].fixed) problem.nodes[i].T_camera_world = pose_of(blocks[i].data());
  summary.usable = true;
  return summary;
}

}  // namespace holdfast::ceres_plugin
