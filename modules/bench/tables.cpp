// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/tables.hpp"

#include <cmath>

#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

namespace {

using Row = std::vector<std::string>;

std::string text_of(double value) { return std::isfinite(value) ? shortest_text(value) : ""; }
std::string text_of(std::size_t value) { return std::to_string(value); }

void add(Row& row, const Spread& spread) {
  row.insert(row.end(), {text_of(spread.median), text_of(spread.least), text_of(spread.most)});
}

ReportTable table(std::string caption, Row header) { return {std::move(caption), std::move(header), {}, {}}; }

/// "ate_rmse_m" and the like.
std::string column(Quantity quantity, const std::string& statistic) {
  const std::string name = quantity == Quantity::ate               ? "ate"
                           : quantity == Quantity::rpe_translation ? "rpe_translation"
                                                                   : "rpe_rotation";
  return name + "_" + statistic + (quantity == Quantity::rpe_rotation ? "_deg" : "_m");
}

constexpr std::array<const char*, 6> statistic_columns = {"rmse", "mean", "median", "sd", "min", "max"};

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_line(const Row& cells) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) line += (i == 0 ? "" : ",") + csv_cell(cells[i]);
  return line + "\n";
}

std::string markdown_line(const Row& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) {
    line += ' ';
    for (const char c : markdown_text(cell)) line += c == '|' ? std::string("\\|") : std::string(1, c);
    line += " |";
  }
  return line + "\n";
}

}  // namespace

std::string markdown_text(const std::string& text) {
  constexpr const char* digits = "0123456789abcdef";
  std::string result;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '<')
      result += "&lt;";
    else if (c == '\n' || c == '\r' || c == '\t')
      result += ' ';
    else if (byte < 0x20 || byte == 0x7f)
      (result += "\\x") += {digits[byte >> 4], digits[byte & 15]};
    else
      result += c;
  }
  return result;
}

std::string to_markdown(const ReportTable& t) {
  std::string text = markdown_line(t.header) + "|";
  for (std::size_t i = 0; i < t.header.size(); ++i) text += i == 0 ? "---|" : "---:|";
  text += "\n";
  for (const Row& row : t.rows) text += markdown_line(row);
  return text;
}

std::string to_csv(const ReportTable& t) {
  std::string text = csv_line(t.header);
  for (const Row& row : t.rows) text += csv_line(row);
  return text;
}

const std::string& published_name(const MatrixSequence& sequence) {
  return sequence.published.empty() ? sequence.name : sequence.published;
}

ReportTable runs_table(const RunPlan& plan, const BenchResults& results) {
  ReportTable t = table("Runs", {"variant", "sequence", "seed", "repeat", "status", "code", "frames", "poses",
                                 "coverage", "not_finite", "malformed", "truth"});
  for (const Quantity quantity : all_quantities)
    for (const char* statistic : statistic_columns) t.header.push_back(column(quantity, statistic));
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    if (!results.results[i]) continue;
    const PlannedRun& run = plan.runs[i];
    const RunResult& result = *results.results[i];
    Row row = {plan.variants[run.variant].name,
               plan.matrix.sequences[run.sequence].name,
               plan.variants[run.variant].is_external() ? "" : std::to_string(run.seed),
               std::to_string(run.repeat),
               to_string(result.status),
               std::to_string(result.code),
               text_of(result.frames),
               text_of(result.poses),
               text_of(result.coverage()),
               text_of(result.not_finite),
               text_of(result.malformed),
               result.has_errors ? result.truth_frame : ""};
    for (const SixStatistics& statistics : result.errors)
      for (const double value : statistics) row.push_back(result.has_errors ? text_of(value) : "");
    t.rows.push_back(std::move(row));
  }
  return t;
}

ReportTable cells_table(const RunPlan& plan, const Analysis& analysis) {
  ReportTable t =
      table("Cells", {"variant", "sequence", "runs", "counted", "coverage_median", "coverage_least", "coverage_most"});
  for (const Quantity quantity : all_quantities)
    for (const char* part : {"median", "least", "most"})
      t.header.push_back(column(quantity, std::string("rmse_") + part));
  for (const Cell& cell : analysis.cells) {
    Row row = {plan.variants[cell.variant].name, plan.matrix.sequences[cell.sequence].name, text_of(cell.runs.size()),
               text_of(cell.counted)};
    add(row, cell.coverage);
    for (const auto& statistics : cell.errors) add(row, statistics[0]);
    t.rows.push_back(std::move(row));
  }
  return t;
}

ReportTable improvements_table(const RunPlan& plan, const Analysis& analysis) {
  ReportTable t = table("Improvements", {"variant", "baseline", "sequence", "quantity", "unit", "statistic",
                                         "baseline_value", "value", "improvement_percent"});
  for (const Improvement& improvement : analysis.improvements)
    for (std::size_t q = 0; q < all_quantities.size(); ++q)
      for (std::size_t s = 0; s < statistic_names.size(); ++s)
        t.rows.push_back({plan.variants[improvement.variant].name, plan.variants[improvement.baseline].name,
                          plan.matrix.sequences[improvement.sequence].name, to_string(all_quantities[q]),
                          unit_of(all_quantities[q]), statistic_names[s], text_of(improvement.before[q][s]),
                          text_of(improvement.after[q][s]), text_of(improvement.percent[q][s])});
  return t;
}

ReportTable comparisons_table(const RunPlan& plan, const Analysis& analysis) {
  ReportTable t =
      table("Comparisons", {"after", "before", "quantity", "unit", "sequences", "left_out", "better", "worse",
                            "median_gain", "median_gain_percent", "interval_low", "interval_high", "pairs", "rank_sum",
                            "p", "p_holm", "verdict", "coverage_least_after", "coverage_least_before"});
  for (const Comparison& c : analysis.comparisons) {
    const auto tested = [&](double value) { return c.enough ? text_of(value) : ""; };
    t.rows.push_back({plan.variants[c.after].name, plan.variants[c.before].name, to_string(c.quantity),
                      unit_of(c.quantity), text_of(c.sequences.size()), text_of(c.left_out), text_of(c.better),
                      text_of(c.worse), text_of(c.gain), text_of(c.gain_percent), tested(c.interval.low),
                      tested(c.interval.high), text_of(c.test.pairs), tested(c.test.rank_sum), tested(c.test.p),
                      tested(c.adjusted), c.verdict(), c.sequences.empty() ? "" : text_of(c.least_coverage_after),
                      c.sequences.empty() ? "" : text_of(c.least_coverage_before)});
  }
  return t;
}

ReportTable published_table(const RunPlan& plan, const PublishedResults& published) {
  ReportTable t = table("Published", {"system", "sequence", "ate_rmse_m", "alignment", "input", "source", "protocol"});
  for (const PublishedResult& result : published.results)
    for (const MatrixSequence& sequence : plan.matrix.sequences)
      if (const auto value = result.values.find(published_name(sequence)); value != result.values.end())
        t.rows.push_back({result.system, sequence.name, text_of(value->second), result.alignment, result.input,
                          result.citation, result.protocol});
  return t;
}

ReportTable cost_table(const RunPlan& plan, const Analysis& analysis) {
  ReportTable t = table("Cost", {"variant", "sequence", "runs", "alone"});
  for (const char* name : {"wall_s", "processor_s", "tracking_s_per_frame", "wall_s_per_frame", "memory_bytes",
                           "processor_ratio", "other_processors", "load_average"})
    for (const char* part : {"_median", "_least", "_most"}) t.header.push_back(std::string(name) + part);
  for (const Cell& cell : analysis.cells) {
    Row row = {plan.variants[cell.variant].name, plan.matrix.sequences[cell.sequence].name, text_of(cell.counted),
               cell.alone ? "yes" : "no"};
    for (const Spread* spread : {&cell.wall, &cell.processor, &cell.tracking, &cell.wall_per_frame, &cell.memory,
                                 &cell.processor_ratio, &cell.other_processors, &cell.load_average})
      add(row, *spread);
    t.rows.push_back(std::move(row));
  }
  return t;
}

}  // namespace holdfast
