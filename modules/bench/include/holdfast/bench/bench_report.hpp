// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "holdfast/bench/analysis.hpp"
#include "holdfast/bench/published.hpp"

namespace holdfast {

/// The accuracy of a bench for people to read: what helps, by how much, is it sure; errors by variant and by cell;
/// improvements as tables 2 and 3 of Zeng et al. 2023; published figures; what did not finish. Holds neither times nor
/// anything else of the machine: the same bytes from equal results.
std::string accuracy_report(const RunPlan& plan, const BenchResults& results, const Analysis& analysis,
                            const PublishedResults& published);

/// Time and memory, the machine, and whether runs stood alone.
std::string cost_report(const RunPlan& plan, const BenchResults& results, const Analysis& analysis,
                        const PublishedResults& published);

/// Everything of both, and where each run's files are, for programs and pages that draw (docs/benchmarking.md lists the
/// keys).
std::string results_json(const RunPlan& plan, const BenchResults& results, const Analysis& analysis,
                         const PublishedResults& published);

/// Writes report.md, cost.md, report.html, results.json and tables/*.csv into the folder of a bench.
void write_bench_reports(const std::filesystem::path& output, const RunPlan& plan, const BenchResults& results,
                         const PublishedResults& published);

}  // namespace holdfast
