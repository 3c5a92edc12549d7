// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/SparseCholesky>
#include <cmath>
#include <vector>

#include "holdfast/core/check.hpp"
#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast {

namespace {

/// The logarithms of the nodes' scales that agree best with those of the edges, by least squares; fixed nodes have 0.
/// Empty when they are not determined.
std::vector<double> log_scales(const PoseGraphProblem& problem) {
  for (const PoseGraphProblem::Edge& edge : problem.edges)
    HOLDFAST_CHECK(edge.from < problem.nodes.size() && edge.to < problem.nodes.size(),
                   "edge from " << edge.from << " to " << edge.to << " of " << problem.nodes.size() << " nodes");
  std::vector<int> unknown(problem.nodes.size(), -1);
  int count = 0;
  for (std::size_t i = 0; i < problem.nodes.size(); ++i)
    if (!problem.nodes[i].fixed) unknown[i] = count++;
  std::vector<double> result(problem.nodes.size(), 0.0);
  if (count == 0) return result;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  for (const PoseGraphProblem::Edge& edge : problem.edges) {
    const double measured = std::log(edge.scale);
    if (!std::isfinite(measured) || !std::isfinite(edge.weight)) return {};
    const int from = unknown[edge.from], to = unknown[edge.to];
    if (from >= 0) {
      entries.emplace_back(from, from, edge.weight);
      right[from] += edge.weight * measured;
    }
    if (to >= 0) {
      entries.emplace_back(to, to, edge.weight);
      right[to] -= edge.weight * measured;
    }
    if (from >= 0 && to >= 0) {
      entries.emplace_back(from, to, -edge.weight);
      entries.emplace_back(to, from, -edge.weight);
    }
  }
  Eigen::SparseMatrix<double> normal(count, count);
  normal.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
  if (solver.info() != Eigen::Success) return {};
  const Eigen::VectorXd solution = solver.solve(right);
  if (!solution.allFinite()) return {};
  for (std::size_t i = 0; i < result.size(); ++i)
    if (unknown[i] >= 0) result[i] = solution[unknown[i]];
  return result;
}

}  // namespace

GraphSummary Optimizer::optimize_similarity_graph(PoseGraphProblem& problem) {
  const std::vector<double> logarithms = log_scales(problem);
  if (logarithms.size() != problem.nodes.size()) return {};
  PoseGraphProblem rigid = problem;
  for (std::size_t i = 0; i < rigid.nodes.size(); ++i)
    rigid.nodes[i].T_camera_world.translation() *= std::exp(logarithms[i]);  // a first guess: the optimizer moves it
  for (PoseGraphProblem::Edge& edge : rigid.edges) {
    // The translation is known in the unit of `to`, and by the scale in that of `from`: the mean of both.
    const double by_to = logarithms[edge.to], by_from = logarithms[edge.from] - std::log(edge.scale);
    edge.T_to_from.translation() *= std::exp(0.5 * (by_to + by_from));
    edge.scale = 1.0;
  }
  const GraphSummary summary = optimize_pose_graph(rigid);
  if (!summary.usable) return summary;
  for (std::size_t i = 0; i < problem.nodes.size(); ++i) {
    problem.nodes[i].T_camera_world = rigid.nodes[i].T_camera_world;
    problem.nodes[i].scale = std::exp(logarithms[i]);
  }
  return summary;
}

}  // namespace holdfast
