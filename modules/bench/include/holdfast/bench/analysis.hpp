// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "holdfast/bench/paired_test.hpp"
#include "holdfast/bench/run_scheduler.hpp"

namespace holdfast {

/// Median, minimum, maximum and mean of several runs; NaN without values.
struct Spread {
  double median = Statistics::none;
  double least = Statistics::none;
  double most = Statistics::none;
  std::size_t count = 0;
  double mean = Statistics::none;
};
/// Ignores values that are NaN.
Spread spread_of(const std::vector<double>& values);

/// All runs of a variant on a sequence. Errors are those of finished runs (RunResult::counts).
struct Cell {
  std::size_t variant = 0;
  std::size_t sequence = 0;
  std::vector<std::size_t> runs;                ///< places in the plan
  std::size_t counted = 0;                      ///< runs whose errors are included
  Spread coverage;                              ///< of all runs, 0 to 1
  std::array<std::array<Spread, 6>, 3> errors;  ///< by Quantity and statistic
  Spread wall;                                  ///< of the process [s]
  Spread processor;                             ///< user and system time [s]
  Spread tracking;                              ///< median per frame of a run of ours [s]
  Spread wall_per_frame;                        ///< whole process / frames [s]
  Spread memory;                                ///< peak, resident [bytes]
  Spread processor_ratio;                       ///< processor time / wall time
  Spread other_processors;                      ///< kept busy by other programs during its runs, of all runs
  Spread load_average;                          ///< when its runs began, of all runs
  bool alone = true;                            ///< RunCost::is_undisturbed() of all its runs

  double error(Quantity quantity) const { return errors[static_cast<std::size_t>(quantity)][0].median; }  ///< RMSE
};

/// The six statistics of a variant against its baseline's on one sequence, both medians over runs: table 2 of Zeng et
/// al. 2023. An improvement is (baseline - value) / baseline, in per cent.
struct Improvement {
  std::size_t variant = 0;
  std::size_t baseline = 0;
  std::size_t sequence = 0;
  std::array<SixStatistics, 3> before, after, percent;  ///< by Quantity
};

/// Two variants over all sequences on which both have a figure: the RMSE of a quantity, median over runs.
struct Comparison {
  std::size_t before = 0;
  std::size_t after = 0;
  Quantity quantity = Quantity::ate;
  std::vector<std::size_t> sequences;      ///< sequences with a pair
  std::size_t left_out = 0;                ///< sequences on which one of them has no figure
  std::size_t better = 0, worse = 0;       ///< sequences on which `after` is
  double gain = Statistics::none;          ///< median of before - after, in the quantity's unit
  double gain_percent = Statistics::none;  ///< median of (before - after) / before
  Interval interval;                       ///< of the gain; only with enough pairs
  SignedRank test;
  bool enough = false;    ///< pairs to test
  double adjusted = 1.0;  ///< p after Holm's correction for the tests of this quantity
  double least_coverage_before = 1.0, least_coverage_after = 1.0;  ///< over these sequences

  bool is_significant() const { return enough && test.p < 0.05; }
  /// "too few to tell", "not significant", "significant alone" (before Holm's correction only) or "significant".
  const char* verdict() const {
    if (!enough) return "too few to tell";
    if (!is_significant()) return "not significant";
    return adjusted < 0.05 ? "significant" : "significant alone";
  }
};

/// Statistics of a benchmark's results, by cell and relative to the baseline.
struct Analysis {
  std::vector<Cell> cells;  ///< in the plan's order
  std::vector<Improvement> improvements;
  std::vector<Comparison> comparisons;

  const Cell* find(std::size_t variant, std::size_t sequence) const;
};

/// Analyses the results; runs without a result are ignored, so that an incomplete benchmark can be analysed.
Analysis analyse(const RunPlan& plan, const BenchResults& results);

/// Formats a comparison as a sentence.
std::string sentence(const RunPlan& plan, const Comparison& comparison);

}  // namespace holdfast
