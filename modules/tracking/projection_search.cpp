// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/projection_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "holdfast/core/hamming.hpp"

namespace holdfast {

const std::vector<ProjectionMatch>& ProjectionSearch::match(const SearchWindows& windows, const Descriptor* descriptors,
                                                            const Frame& frame, const MatchRule& rule) {
  constexpr int unmatched = std::numeric_limits<int>::max();
  best_of_feature_.assign(frame.size(), ProjectionMatch{0, 0, unmatched});
  const std::vector<std::uint8_t>& octave = frame.features.octave;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    candidates_.clear();
    frame.grid.query(windows.x[i], windows.y[i], windows.radius[i], frame.x, frame.y, candidates_);
    const float right_x = windows.right_x[i], radius = windows.radius[i];
    const int lowest = windows.lowest_level[i], highest = windows.highest_level[i];
    std::erase_if(candidates_, [&](std::uint32_t feature) {
      if (octave[feature] < lowest || octave[feature] > highest || frame.map_points[feature].valid()) return true;
      return std::abs(frame.right_x[feature] - right_x) > radius;  // false when either is NaN
    });
    if (candidates_.empty()) continue;
    distances_.resize(candidates_.size());
    const std::uint32_t source = windows.source[i];
    hamming_distances(descriptors[source], frame.features.descriptors.data(), candidates_, distances_.data());

    int best_distance = unmatched, second_distance = unmatched;
    std::uint32_t best = 0, second = 0;
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      if (distances_[k] < best_distance) {
        second_distance = best_distance, second = best;
        best_distance = distances_[k], best = candidates_[k];
      } else if (distances_[k] < second_distance) {
        second_distance = distances_[k], second = candidates_[k];
      }
    }
    if (best_distance > rule.maximum_distance) continue;
    if (second_distance != unmatched && octave[best] == octave[second] &&
        static_cast<float>(best_distance) > rule.ratio * static_cast<float>(second_distance))
      continue;
    if (best_distance < best_of_feature_[best].distance) best_of_feature_[best] = {source, best, best_distance};
  }
  matches_.clear();
  for (const ProjectionMatch& match : best_of_feature_)
    if (match.distance != unmatched) matches_.push_back(match);
  if (rule.angles != nullptr) keep_consistent_rotations(frame, rule.angles);
  return matches_;
}

void ProjectionSearch::keep_consistent_rotations(const Frame& frame, const float* angles) {
  constexpr int bins = 30;
  const auto bin_of = [&](const ProjectionMatch& match) {
    float turn = (frame.features.angle[match.feature] - angles[match.source]) / (2.0F * std::numbers::pi_v<float>);
    turn -= std::floor(turn);
    return std::min(static_cast<int>(turn * bins + 0.5F) % bins, bins - 1);
  };
  std::array<int, bins> histogram{};
  for (const ProjectionMatch& match : matches_) ++histogram[bin_of(match)];
  std::array<int, bins> order;
  for (int i = 0; i < bins; ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return histogram[a] > histogram[b]; });
  std::array<bool, bins> kept{};
  for (int rank = 0; rank < 3; ++rank)  // a far weaker second or third direction is chance
    kept[order[rank]] = rank == 0 || histogram[order[rank]] * 10 >= histogram[order[0]];
  std::erase_if(matches_, [&](const ProjectionMatch& match) { return !kept[bin_of(match)]; });
}

}  // namespace holdfast
