// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/interfaces/bundle_selection.hpp"
#include "kernels.hpp"

namespace holdfast::schur_plugin {

/// The selected part of a bundle problem, in the order of the kernels. Free poses have the first numbers, in the order
/// of the problem, then the fixed ones; points keep their order. Keeps its memory between problems.
class BundleArrays {
 public:
  static constexpr std::uint32_t none = static_cast<std::uint32_t>(-1);

  /// Copies the selected observations and the state of the problem.
  void build(const BundleProblem& problem, const BundleSelection& selection);
  /// Copies the selected observations again, without those marked in `outliers`, one flag per entry.
  void leave_out(const BundleProblem& problem, const std::vector<std::uint8_t>& outliers);

  std::size_t free_count() const { return free_count_; }
  std::size_t point_count() const { return points.size() / 3; }
  std::size_t entry_count() const { return entries.size(); }
  std::size_t group_count_of_largest_point() const { return largest_; }
  /// The arrays for the kernels, to be completed with camera and limits.
  BundleView view() const;

  std::vector<double> poses;                 ///< pose_size each
  std::vector<double> points;                ///< three each
  std::vector<std::uint32_t> pose_indices;   ///< in the problem, of `poses`
  std::vector<std::uint32_t> point_indices;  ///< in the problem, of `points`
  std::vector<std::uint32_t> entries;        ///< index of the observation in the problem; none = fills up a group
  std::vector<std::uint32_t> first_group, first_coupling;
  std::vector<std::size_t> first_pair;
  std::vector<std::int32_t> pose;  ///< of each entry

 private:
  void number_poses(const BundleProblem& problem, const BundleSelection& selection);
  void order_by_point(const BundleProblem& problem, const BundleSelection& selection);
  void fill_entries(const BundleProblem& problem);
  void add_entry(const BundleProblem::Observation& observation, std::uint32_t index);
  void fill_group();

  std::size_t free_count_ = 0, largest_ = 0;
  std::vector<std::int32_t> number_of_pose_;    // of each pose of the problem
  std::vector<std::int32_t> number_of_point_;   // of each point of the problem
  std::vector<std::uint32_t> ordered_, first_;  // observations by point, and where those of each point begin
  std::vector<float> x_, y_, right_x_, inverse_sigma2_, weight_;
};

}  // namespace holdfast::schur_plugin
