// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "holdfast/core/map_inertia.hpp"
#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast {

/// Observations of points by keyframes that share hardly any other point with those that mostly observe them. Such
/// ties are few, so that wrong ones, as on a person who stood in both views, agree with each other and bend the whole
/// map. Inertial measurements between the same keyframes decide: ties are taken out of the problem, it is solved, and
/// those that contradict the result are rejected (an innovation test of each observation, as in filters).
class WeakTies {
 public:
  /// Takes ties out. `cluster`: of keyframes that share ample points, by pose. Ties stay where no inertial factors
  /// connect the clusters, or only with a deviation that says nothing.
  void take_out(BundleProblem& problem, std::span<const std::uint32_t> cluster, const MapInertia& estimates);
  bool empty() const { return ties_.empty(); }
  /// Puts those back that agree with the solution to within its deviation, or all.
  void put_back_agreeing(BundleProblem& problem);
  void put_back_all(BundleProblem& problem);
  /// Adds the rejected ones as outliers and returns their number. To be called after the last solution.
  std::size_t add_rejected(BundleProblem& problem);

 private:
  /// Standard deviations between two clusters [m], [rad].
  struct Deviation {
    double position = 0.0, rotation = 0.0;
  };
  struct Tie {
    BundleProblem::Observation observation;
    Deviation deviation;
  };

  static std::vector<std::vector<Deviation>> deviations_between(const BundleProblem& problem,
                                                                std::span<const std::uint32_t> cluster,
                                                                std::size_t count, const MapInertia& estimates);
  std::vector<double> depth_deviations(const BundleProblem& problem) const;
  /// Direction from a pose to a point in the world frame.
  static Eigen::Vector3d home_ray(const BundleProblem& problem, std::uint32_t home, std::uint32_t point);
  bool agrees(const BundleProblem& problem, const Tie& tie, double depth_deviation) const;

  std::vector<std::uint32_t> cluster_;  // by pose
  std::vector<std::uint32_t> homes_;    // by point, the first pose of the cluster that mostly observes it
  std::vector<Tie> ties_;
  std::vector<BundleProblem::Observation> rejected_;
};

}  // namespace holdfast
