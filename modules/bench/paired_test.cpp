// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/paired_test.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/evaluation/statistics.hpp"

namespace holdfast {

namespace {

/// Twice the rank of each magnitude: whole numbers even where ranks are shared.
std::vector<std::size_t> doubled_ranks(const std::vector<double>& magnitudes) {
  std::vector<std::size_t> order(magnitudes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return magnitudes[a] < magnitudes[b]; });
  std::vector<std::size_t> ranks(magnitudes.size());
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin;
    while (end < order.size() && magnitudes[order[end]] == magnitudes[order[begin]]) ++end;
    for (std::size_t i = begin; i < end; ++i) ranks[order[i]] = begin + 1 + end;  // 2 * mean of begin + 1 ... end
    begin = end;
  }
  return ranks;
}

}  // namespace

SignedRank wilcoxon_signed_rank(std::span<const double> differences) {
  std::vector<double> magnitudes;
  std::vector<bool> is_positive;
  for (const double difference : differences) {
    HOLDFAST_CHECK(std::isfinite(difference), "the difference " << difference);
    if (difference == 0.0) continue;
    magnitudes.push_back(std::abs(difference));
    is_positive.push_back(difference > 0.0);
  }
  SignedRank result;
  result.pairs = magnitudes.size();
  if (result.pairs == 0) return result;
  const std::vector<std::size_t> ranks = doubled_ranks(magnitudes);
  const std::size_t total = result.pairs * (result.pairs + 1);
  // probability[s]: that the doubled rank sum of fair signs is s.
  std::vector<double> probability(total + 1, 0.0);
  probability[0] = 1.0;
  std::size_t reached = 0, positive = 0;
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    reached += ranks[i];
    for (std::size_t sum = reached + 1; sum-- > 0;)
      probability[sum] = 0.5 * (probability[sum] + (sum >= ranks[i] ? probability[sum - ranks[i]] : 0.0));
    if (is_positive[i]) positive += ranks[i];
  }
  const std::size_t tail = std::min(positive, total - positive);
  const double below =
      std::accumulate(probability.begin(), probability.begin() + static_cast<std::ptrdiff_t>(tail) + 1, 0.0);
  result.rank_sum = 0.5 * static_cast<double>(positive);
  result.p = std::min(1.0, 2.0 * below);
  return result;
}

Interval bootstrap_median(std::span<const double> values, std::uint64_t seed, int resamples) {
  HOLDFAST_CHECK(!values.empty() && resamples > 0, values.size() << " values, " << resamples << " resamples");
  Random random(seed);
  std::vector<double> medians, draw(values.size());
  for (int i = 0; i < resamples; ++i) {
    for (double& value : draw) value = values[random.below(static_cast<std::uint32_t>(values.size()))];
    medians.push_back(median(draw));
  }
  return {percentile(medians, 2.5), percentile(medians, 97.5)};
}

std::vector<double> holm_adjusted(std::span<const double> p_values) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p_values[a] < p_values[b]; });
  std::vector<double> adjusted(p_values.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    largest = std::max(largest, std::min(1.0, static_cast<double>(order.size() - i) * p_values[order[i]]));
    adjusted[order[i]] = largest;
  }
  return adjusted;
}

}  // namespace holdfast
