// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "holdfast/bench/analysis.hpp"
#include "holdfast/bench/published.hpp"
#include "holdfast/evaluation/report.hpp"

namespace holdfast {

/// Escapes text for one line of Markdown: HTML is not interpreted, line feeds become blanks, other control characters
/// are written as \x1b.
std::string markdown_text(const std::string& text);
/// A table as Markdown, the first column flush left and the others flush right. Cells are escaped by markdown_text(),
/// and '|' is, too.
std::string to_markdown(const ReportTable& table);
/// A table as CSV with the header as its first line; quoted as RFC 4180 wants it.
std::string to_csv(const ReportTable& table);

// Tables for programs: one fact per row, full precision, an empty text where there is no figure. All except
// cost_table() depend on the plan and the results only.

/// Every run: how it ended, its poses and its 18 errors.
ReportTable runs_table(const RunPlan& plan, const BenchResults& results);
/// Every cell: runs, coverage, and median, least and most of each RMSE.
ReportTable cells_table(const RunPlan& plan, const Analysis& analysis);
/// Every statistic of every quantity against the baseline.
ReportTable improvements_table(const RunPlan& plan, const Analysis& analysis);
ReportTable comparisons_table(const RunPlan& plan, const Analysis& analysis);
/// Published figures of the matrix's sequences, each with source and protocol.
ReportTable published_table(const RunPlan& plan, const PublishedResults& published);
/// Time and memory of every cell.
ReportTable cost_table(const RunPlan& plan, const Analysis& analysis);

/// Name of a sequence in the file of published figures.
const std::string& published_name(const MatrixSequence& sequence);

}  // namespace holdfast
