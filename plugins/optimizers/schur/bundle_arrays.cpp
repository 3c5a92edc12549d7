// SPDX-License-Identifier: BSD-3-Clause
#include "bundle_arrays.hpp"

#include <algorithm>
#include <limits>

namespace holdfast::schur_plugin {

void BundleArrays::build(const BundleProblem& problem, const BundleSelection& selection) {
  number_poses(problem, selection);
  number_of_point_.assign(problem.points.size(), -1);
  point_indices.clear();
  points.clear();
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    if (!selection.point_counts[i]) continue;
    number_of_point_[i] = static_cast<std::int32_t>(point_indices.size());
    point_indices.push_back(static_cast<std::uint32_t>(i));
    points.insert(points.end(), problem.points[i].data(), problem.points[i].data() + 3);
  }
  order_by_point(problem, selection);
  fill_entries(problem);
}

void BundleArrays::number_poses(const BundleProblem& problem, const BundleSelection& selection) {
  number_of_pose_.assign(problem.poses.size(), -1);
  pose_indices.clear();
  poses.clear();
  const auto add = [this](std::size_t i) {
    number_of_pose_[i] = static_cast<std::int32_t>(pose_indices.size());
    pose_indices.push_back(static_cast<std::uint32_t>(i));
  };
  for (std::size_t i = 0; i < problem.poses.size(); ++i)
    if (selection.pose_moves[i]) add(i);
  free_count_ = pose_indices.size();
  for (std::size_t i = 0; i < problem.poses.size(); ++i)
    if (problem.poses[i].fixed) add(i);
  for (const std::uint32_t i : pose_indices) {
    const Eigen::Isometry3d& T_camera_world = problem.poses[i].T_camera_world;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) poses.push_back(T_camera_world(row, column));
  }
}

void BundleArrays::order_by_point(const BundleProblem& problem, const BundleSelection& selection) {
  first_.assign(point_indices.size() + 1, 0);
  const std::vector<BundleProblem::Observation>& observations = problem.observations;
  for (std::size_t i = 0; i < observations.size(); ++i)
    if (selection.observation_counts[i]) ++first_[number_of_point_[observations[i].point] + 1];
  for (std::size_t p = 0; p + 1 < first_.size(); ++p) first_[p + 1] += first_[p];
  ordered_.resize(first_.back());
  // Fills each point's part from its begin; afterwards first_[p] is the begin of the part after it.
  for (std::size_t i = 0; i < observations.size(); ++i)
    if (selection.observation_counts[i])
      ordered_[first_[number_of_point_[observations[i].point]]++] = static_cast<std::uint32_t>(i);
  std::copy_backward(first_.begin(), first_.end() - 1, first_.end());
  first_[0] = 0;
  for (std::size_t p = 0; p + 1 < first_.size(); ++p)
    std::sort(ordered_.begin() + first_[p], ordered_.begin() + first_[p + 1], [&](std::uint32_t a, std::uint32_t b) {
      const std::int32_t pose_a = number_of_pose_[observations[a].pose], pose_b = number_of_pose_[observations[b].pose];
      return pose_a != pose_b ? pose_a < pose_b : a < b;
    });
}

void BundleArrays::fill_entries(const BundleProblem& problem) {
  entries.clear(), pose.clear();
  x_.clear(), y_.clear(), right_x_.clear(), inverse_sigma2_.clear(), weight_.clear();
  first_group.assign(1, 0), first_coupling.assign(1, 0), first_pair.assign(1, 0);
  largest_ = 0;
  for (std::size_t p = 0; p + 1 < first_.size(); ++p) {
    std::size_t free = 0;
    for (std::uint32_t i = first_[p]; i < first_[p + 1]; ++i) {
      const std::uint32_t index = ordered_[i];
      if (index == none) continue;
      add_entry(problem.observations[index], index);
      free += static_cast<std::size_t>(pose.back()) < free_count_;
    }
    fill_group();
    first_group.push_back(static_cast<std::uint32_t>(entries.size() / lanes));
    first_coupling.push_back(first_coupling.back() + static_cast<std::uint32_t>(free));
    first_pair.push_back(first_pair.back() + free * (free + 1) / 2);
    largest_ = std::max<std::size_t>(largest_, first_group[p + 1] - first_group[p]);
  }
}

void BundleArrays::add_entry(const BundleProblem::Observation& observation, std::uint32_t index) {
  entries.push_back(index);
  pose.push_back(number_of_pose_[observation.pose]);
  x_.push_back(observation.x), y_.push_back(observation.y), right_x_.push_back(observation.right_x);
  inverse_sigma2_.push_back(observation.inverse_sigma2), weight_.push_back(observation.weight);
}

void BundleArrays::fill_group() {
  while (entries.size() % lanes != 0) {
    entries.push_back(none);
    pose.push_back(pose.back());
    x_.push_back(0.0f), y_.push_back(0.0f), right_x_.push_back(std::numeric_limits<float>::quiet_NaN());
    inverse_sigma2_.push_back(0.0f), weight_.push_back(0.0f);
  }
}

void BundleArrays::leave_out(const BundleProblem& problem, const std::vector<std::uint8_t>& outliers) {
  std::size_t next = 0;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (entries[i] == none) continue;
    while (ordered_[next] == none) ++next;
    if (outliers[i]) ordered_[next] = none;
    ++next;
  }
  fill_entries(problem);
}

BundleView BundleArrays::view() const {
  BundleView view{};
  view.point_count = point_count();
  view.first_group = first_group.data();
  view.first_coupling = first_coupling.data();
  view.first_pair = first_pair.data();
  view.x = x_.data(), view.y = y_.data(), view.right_x = right_x_.data();
  view.inverse_sigma2 = inverse_sigma2_.data(), view.weight = weight_.data();
  view.pose = pose.data();
  view.poses = poses.data();
  view.points = points.data();
  return view;
}

}  // namespace holdfast::schur_plugin
