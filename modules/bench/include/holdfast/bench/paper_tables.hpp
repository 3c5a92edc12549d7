// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/bench/analysis.hpp"
#include "holdfast/bench/published.hpp"
#include "holdfast/evaluation/report.hpp"

namespace holdfast {

/// Tables that papers print: "paper2" has the absolute error (ATE [m]) and "paper3" the relative error (RPE [m/s] and
/// [deg/s]), each with RMSE, S.D., max, min, mean and median by sequence, and the improvement over the baseline in per
/// cent (Zeng et al., Remote Sens. 2023, 15, 5479).
const std::vector<std::string>& paper_table_names();
/// Adds a name that is not yet in the list.
void add_paper_table(const std::string& name, MatrixAnalysis& analysis);
/// Names of the statistics that the rows of these tables may be: rmse, standard_deviation, max, min, mean, median.
std::vector<std::string> table_statistic_names();
/// Adds a statistic, by such a name, to the rows of the tables. An unknown name is a diagnostic.
void add_table_statistic(const PlacedText& name, MatrixAnalysis& analysis, std::vector<Diagnostic>& diagnostics);

/// A table to print.
struct PaperTable {
  struct Cell {
    std::string text;
    bool is_best = false;   ///< smallest of its row, among the variants with the minimum coverage
    bool is_short = false;  ///< runs with less than the minimum coverage
  };
  struct Row {
    std::vector<Cell> cells;    ///< as many as the header
    bool begins_group = false;  ///< the first row of a sequence
  };
  std::string name;     ///< label and beginning of the file name
  std::string caption;  ///< error, unit, and of how many runs a figure is the mean
  std::vector<std::string> header;
  std::size_t text_columns = 2;  ///< flush left; the others are numbers
  std::vector<Row> rows;
  std::vector<std::string> notes;  ///< sentences below the table
};

/// The tables of a name of paper_table_names(). A figure is the mean over the counted runs of a cell, rounded to the
/// decimals of the matrix. A single statistic stands in the caption, and its rows have no column for it. Published
/// systems with more than the RMSE are further columns; paper2 has a second table of the published RMSE if the matrix
/// names published figures of its sequences.
std::vector<PaperTable> paper_tables(const std::string& name, const RunPlan& plan, const Analysis& analysis,
                                     const PublishedResults& published);

/// The table for LaTeX with the package booktabs.
std::string to_latex(const PaperTable& table);
/// The table as Markdown, with its caption and notes.
std::string to_markdown(const PaperTable& table);
/// All figures of a name of paper_table_names(), one per row and in full precision.
ReportTable paper_figures(const std::string& name, const RunPlan& plan, const Analysis& analysis);

/// Text with the characters escaped that LaTeX treats specially.
std::string latex_text(const std::string& text);

}  // namespace holdfast
