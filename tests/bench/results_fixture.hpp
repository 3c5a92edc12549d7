// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "holdfast/bench/bench_report.hpp"

namespace holdfast::test {

/// Two variants on some sequences, one run each; RMSE as given, every other statistic a fixed part of it.
class ResultsTest : public ::testing::Test {
 protected:
  ResultsTest() {
    plan_.matrix.title = "Title";
    for (const char* name : {"plain", "better"}) {
      Variant variant;
      variant.name = name;
      plan_.variants.push_back(variant);
    }
    plan_.variants[1].baseline = 0;
    plan_.comparisons = {{0, 1}};
  }

  RunResult& add(std::size_t variant, std::size_t sequence, double rmse) {
    while (plan_.matrix.sequences.size() <= sequence) {
      MatrixSequence next;
      next.name = "s" + std::to_string(plan_.matrix.sequences.size());
      plan_.matrix.sequences.push_back(next);
    }
    PlannedRun run;
    run.variant = variant;
    run.sequence = sequence;
    run.seed = 1;
    run.repeat = 1;
    for (const PlannedRun& other : plan_.runs)
      run.repeat += other.variant == variant && other.sequence == sequence ? 1 : 0;
    run.id =
        plan_.variants[variant].name + "/" + plan_.matrix.sequences[sequence].name + "/" + std::to_string(run.repeat);
    plan_.runs.push_back(run);
    RunResult result;
    result.status = RunStatus::finished;
    result.frames = 100;
    result.poses = 100;
    result.has_errors = true;
    const double parts[] = {1, 0.9, 0.8, 0.5, 0.1, 2};
    for (std::size_t q = 0; q < 3; ++q)
      for (std::size_t s = 0; s < 6; ++s) result.errors[q][s] = parts[s] * rmse;
    results_.results.emplace_back(result);
    results_.costs.emplace_back(RunCost{});
    return *results_.results.back();
  }
  /// So many sequences on which `better` takes away a growing part.
  void add_pairs(std::size_t count) {
    for (std::size_t s = 0; s < count; ++s) {
      add(0, s, 0.2);
      add(1, s, 0.1 - 0.01 * static_cast<double>(s));
    }
  }
  std::string report() const { return accuracy_report(plan_, results_, analyse(plan_, results_), published_); }

  RunPlan plan_;
  BenchResults results_;
  PublishedResults published_;
};

}  // namespace holdfast::test
