// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "holdfast/bench/analysis.hpp"
#include "holdfast/bench/published.hpp"

namespace holdfast {

/// The accuracy report (report.md): comparisons with effect size and significance, errors by variant and by cell,
/// improvements as in tables 2 and 3 of Zeng et al. 2023, published figures, failed runs. It contains no times and
/// nothing else that depends on the machine, so that equal results give the same bytes.
std::string accuracy_report(const RunPlan& plan, const BenchResults& results, const Analysis& analysis,
                            const PublishedResults& published);

/// The cost report (cost.md): time, memory, machine, and whether runs were executed alone.
std::string cost_report(const RunPlan& plan, const BenchResults& results, const Analysis& analysis,
                        const PublishedResults& published);

/// All results and the paths of the files of each run as JSON (docs/benchmarking.md).
std::string results_json(const RunPlan& plan, const BenchResults& results, const Analysis& analysis,
                         const PublishedResults& published);

/// Writes report.md, cost.md, report.html, results.json and tables/*.csv into the folder of a bench.
void write_bench_reports(const std::filesystem::path& output, const RunPlan& plan, const BenchResults& results,
                         const PublishedResults& published);

}  // namespace holdfast
