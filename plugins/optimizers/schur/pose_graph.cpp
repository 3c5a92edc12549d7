// SPDX-License-Identifier: BSD-3-Clause
#include "pose_graph.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "block_system.hpp"
#include "damping.hpp"
#include "holdfast/core/check.hpp"
#include "holdfast/geometry/relative_pose.hpp"
#include "holdfast/geometry/upright_motion.hpp"

namespace holdfast::schur_plugin {

namespace {

using geometry::Matrix6d, geometry::Vector6d;

/// An edge that takes part; a fixed node has the number -1.
struct ActiveEdge {
  std::uint32_t from = 0, to = 0;
  std::int32_t free_from = -1, free_to = -1;
  Eigen::Isometry3d T_from_to;
  double weight = 1.0;
};

class PoseGraph {
 public:
  PoseGraph(PoseGraphProblem& problem, const SchurSettings& settings) : problem_(problem), settings_(settings) {}

  GraphSummary run() {
    GraphSummary summary;
    if (!choose()) return summary;
    build_system();
    summary.initial_cost = cost(poses_);
    minimise(summary);
    if (!std::isfinite(summary.final_cost)) return summary;
    for (const std::uint32_t node : free_nodes_)
      problem_.nodes[node].T_camera_world = geometry::orthonormalised(poses_[node]);
    summary.usable = true;
    return summary;
  }

 private:
  /// Checks the problem and takes its edges and nodes; returns whether there is something to adjust.
  bool choose();
  void build_system();
  void minimise(GraphSummary& summary);
  double cost(const std::vector<Eigen::Isometry3d>& poses) const;
  void linearise();
  /// Fills moved_poses_; returns whether the damped system could be solved.
  bool find_step(double& predicted_decrease);
  /// With a vertical, the directions in which a node moves; the last two columns are zero, so that blocks keep their
  /// size and the steps along them are zero.
  Matrix6d directions_of(std::uint32_t node) const;
  static void add(double* block, const Matrix6d& value) { Eigen::Map<Matrix6d>(block) += value; }

  PoseGraphProblem& problem_;
  const SchurSettings& settings_;
  std::optional<Eigen::Vector3d> vertical_;  // unit
  Damping damping_;
  std::vector<Eigen::Isometry3d> poses_, moved_poses_;
  std::vector<ActiveEdge> edges_;
  std::vector<std::uint32_t> free_nodes_;
  BlockSystem system_;
  Eigen::VectorXd gradient_, diagonal_, step_;
};

bool PoseGraph::choose() {
  bool has_fixed = false;
  for (const PoseGraphProblem::Node& node : problem_.nodes) {
    if (!node.T_camera_world.matrix().allFinite()) return false;
    poses_.push_back(geometry::orthonormalised(node.T_camera_world));
    has_fixed |= node.fixed;
  }
  if (!has_fixed) return false;
  if (problem_.vertical) vertical_ = problem_.vertical->normalized();
  if (vertical_ && !(std::abs(vertical_->norm() - 1.0) < 1e-6)) return false;
  std::vector<std::int32_t> number(poses_.size(), -1);
  std::vector<std::uint8_t> used(poses_.size());
  for (std::size_t i = 0; i < problem_.edges.size(); ++i) {
    const PoseGraphProblem::Edge& edge = problem_.edges[i];
    HOLDFAST_CHECK(edge.from < poses_.size() && edge.to < poses_.size() && edge.from != edge.to,
                   "edge " << i << " from " << edge.from << " to " << edge.to << " of " << poses_.size() << " nodes");
    if (!edge.T_to_from.matrix().allFinite() || !std::isfinite(edge.weight)) return false;
    if (edge.weight <= 0.0 || (problem_.nodes[edge.from].fixed && problem_.nodes[edge.to].fixed)) continue;
    edges_.push_back({edge.from, edge.to, -1, -1, edge.T_to_from.inverse(), edge.weight});
    used[edge.from] = used[edge.to] = 1;
  }
  for (std::uint32_t i = 0; i < poses_.size(); ++i) {
    if (!used[i] || problem_.nodes[i].fixed) continue;
    number[i] = static_cast<std::int32_t>(free_nodes_.size());
    free_nodes_.push_back(i);
  }
  for (ActiveEdge& edge : edges_) edge.free_from = number[edge.from], edge.free_to = number[edge.to];
  return !edges_.empty();
}

void PoseGraph::build_system() {
  system_.begin_structure(free_nodes_.size(), false);
  for (const ActiveEdge& edge : edges_)
    if (edge.free_from >= 0 && edge.free_to >= 0)
      system_.add_block(std::max(edge.free_from, edge.free_to), std::min(edge.free_from, edge.free_to));
  system_.finish_structure();
  gradient_.resize(static_cast<Eigen::Index>(6 * free_nodes_.size()));
  diagonal_.resize(gradient_.size());
  moved_poses_ = poses_;
}

double PoseGraph::cost(const std::vector<Eigen::Isometry3d>& poses) const {
  double sum = 0.0;
  for (const ActiveEdge& edge : edges_)
    sum +=
        edge.weight * geometry::relative_pose_residual(edge.T_from_to, poses[edge.from], poses[edge.to]).squaredNorm();
  return 0.5 * sum;
}

void PoseGraph::linearise() {
  system_.set_zero();
  gradient_.setZero();
  for (const ActiveEdge& edge : edges_) {
    geometry::RelativePoseError error =
        geometry::relative_pose_error(edge.T_from_to, poses_[edge.from], poses_[edge.to]);
    if (vertical_) {
      error.by_from = (error.by_from * directions_of(edge.from)).eval();
      error.by_to = (error.by_to * directions_of(edge.to)).eval();
    }
    const auto add_node = [&](std::int32_t node, const Matrix6d& jacobian) {
      if (node < 0) return;
      const auto i = static_cast<std::size_t>(node);
      add(system_.elements(system_.block(i, i)), edge.weight * jacobian.transpose() * jacobian);
      gradient_.segment<6>(6 * node) += edge.weight * jacobian.transpose() * error.residual;
    };
    add_node(edge.free_from, error.by_from);
    add_node(edge.free_to, error.by_to);
    if (edge.free_from < 0 || edge.free_to < 0) continue;
    const bool forward = edge.free_to > edge.free_from;
    const Matrix6d &row = forward ? error.by_to : error.by_from, &column = forward ? error.by_from : error.by_to;
    const auto block = system_.block(static_cast<std::size_t>(std::max(edge.free_from, edge.free_to)),
                                     static_cast<std::size_t>(std::min(edge.free_from, edge.free_to)));
    add(system_.elements(block), edge.weight * row.transpose() * column);
  }
}

bool PoseGraph::find_step(double& predicted_decrease) {
  linearise();
  for (std::size_t i = 0; i < free_nodes_.size(); ++i) {
    double* block = system_.elements(system_.block(i, i));
    for (std::size_t k = 0; k < 6; ++k) {
      const double damping = damping_.value() * std::clamp(block[7 * k], 1e-6, 1e32);
      diagonal_[static_cast<Eigen::Index>(6 * i + k)] = damping;
      block[7 * k] += damping;
    }
  }
  step_ = -gradient_;
  if (!system_.solve(step_)) return false;
  predicted_decrease = 0.5 * (step_.dot(diagonal_.cwiseProduct(step_)) - gradient_.dot(step_));
  for (std::size_t i = 0; i < free_nodes_.size(); ++i) {
    const std::uint32_t node = free_nodes_[i];
    Vector6d step = step_.segment<6>(static_cast<Eigen::Index>(6 * i));
    if (vertical_) step = (directions_of(node) * step).eval();
    moved_poses_[node] = geometry::exp_se3(step) * poses_[node];
  }
  return true;
}

Matrix6d PoseGraph::directions_of(std::uint32_t node) const {
  Matrix6d directions = Matrix6d::Zero();
  directions.leftCols<4>() = geometry::upright_basis(poses_[node].linear(), *vertical_);
  return directions;
}

void PoseGraph::minimise(GraphSummary& summary) {
  double current = summary.final_cost = summary.initial_cost;
  for (int i = 0; i < problem_.iterations && !damping_.is_hopeless(); ++i) {
    ++summary.iterations;
    double predicted = 0.0;
    if (!find_step(predicted)) {
      damping_.refuse();
      continue;
    }
    const double moved = cost(moved_poses_);
    const double decrease = current - moved;
    if (decrease > minimum_gain * predicted && predicted > 0.0) {
      poses_.swap(moved_poses_);
      damping_.accept(decrease / predicted);
      summary.final_cost = current = moved;
    } else {
      damping_.refuse();
    }
    if (std::abs(decrease) <= settings_.graph_tolerance * current) break;
  }
}

}  // namespace

GraphSummary adjust_pose_graph(PoseGraphProblem& problem, const SchurSettings& settings) {
  return PoseGraph(problem, settings).run();
}

}  // namespace holdfast::schur_plugin
