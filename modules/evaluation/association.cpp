// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/association.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "holdfast/core/error.hpp"

namespace holdfast {

std::vector<StampPair> pair_stamps(std::span<const double> first, std::span<const double> second,
                                   double max_difference) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> candidates;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    // The window moves with the stamps; the small margin leaves the decision to the exact test below.
    while (begin < second.size() && second[begin] < first[i] - 2.0 * max_difference) ++begin;
    for (std::size_t j = begin; j < second.size() && second[j] <= first[i] + 2.0 * max_difference; ++j) {
      const double difference = std::abs(first[i] - second[j]);
      if (difference < max_difference) candidates.emplace_back(difference, i, j);
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<char> first_taken(first.size(), 0), second_taken(second.size(), 0);
  std::vector<StampPair> pairs;
  for (const auto& [difference, i, j] : candidates) {
    if (first_taken[i] || second_taken[j]) continue;
    first_taken[i] = second_taken[j] = 1;
    pairs.push_back({i, j});
  }
  std::sort(pairs.begin(), pairs.end(), [](const StampPair& a, const StampPair& b) { return a.first < b.first; });
  return pairs;
}

std::size_t nearest_stamp(std::span<const double> sorted, double time) {
  HOLDFAST_CHECK(!sorted.empty(), "no stamps; time " << time);
  const auto above = std::lower_bound(sorted.begin(), sorted.end(), time);
  const auto index = static_cast<std::size_t>(above - sorted.begin());
  if (index == 0) return 0;
  if (index == sorted.size()) return index - 1;
  return std::abs(sorted[index - 1] - time) <= std::abs(sorted[index] - time) ? index - 1 : index;
}

}  // namespace holdfast
