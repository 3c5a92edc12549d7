// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/paper_tables.hpp"

#include <algorithm>
#include <cmath>

#include "error_keys.hpp"
#include "holdfast/bench/error_text.hpp"
#include "holdfast/bench/tables.hpp"
#include "holdfast/plugin/did_you_mean.hpp"

namespace holdfast {

namespace {

/// Places in SixStatistics in the order in which papers print them.
constexpr std::array<std::size_t, 6> printed_order = {0, 3, 5, 4, 1, 2};
constexpr std::array<const char*, 6> printed_names = {"RMSE", "Mean", "Median", "S.D.", "Min", "Max"};

const std::string no_figure = "-";

std::vector<Quantity> quantities_of(const std::string& name) {
  if (name == "paper2") return {Quantity::ate};
  return {Quantity::rpe_translation, Quantity::rpe_rotation};
}

double improvement_percent(double before, double after) { return 100.0 * (before - after) / before; }

class PaperTableMaker {
 public:
  PaperTableMaker(const RunPlan& plan, const Analysis& analysis, const PublishedResults& published)
      : plan_(plan), analysis_(analysis), decimals_(plan.matrix.analysis.decimals) {
    for (std::size_t variant = 0; variant < plan.variants.size(); ++variant)
      if (std::any_of(analysis.cells.begin(), analysis.cells.end(),
                      [&](const Cell& cell) { return cell.variant == variant; }))
        variants_.push_back(variant);
    for (const std::size_t statistic : printed_order) {
      const std::vector<std::size_t>& chosen = plan.matrix.analysis.statistics;
      if (chosen.empty() || std::find(chosen.begin(), chosen.end(), statistic) != chosen.end())
        statistics_.push_back(statistic);
    }
    for (const PublishedResult& result : published.results)
      if (is_of_these_sequences(result)) published_.push_back(&result);
  }

  PaperTable errors(const std::string& label, Quantity quantity) {
    PaperTable table;
    table.name = label;
    table.caption = std::string(to_string(quantity)) +
                    (has_one_statistic() ? " " + statistic_name(statistics_[0]) : "") + " [" + unit_of(quantity) + "]" +
                    count_text();
    table.header = {"Sequence"};
    if (!has_one_statistic()) table.header.emplace_back("Statistic");
    table.text_columns = table.header.size();
    for (const std::size_t variant : variants_) {
      table.header.push_back(column_name(variant));
      if (plan_.variants[variant].baseline)
        table.header.push_back("over " + column_name(*plan_.variants[variant].baseline));
    }
    const std::vector<const PublishedResult*> printed = printed_columns(quantity);
    for (const PublishedResult* result : printed) table.header.push_back(result->marked_system() + ", as printed");
    for (std::size_t sequence = 0; sequence < plan_.matrix.sequences.size(); ++sequence) {
      bool is_first = true;
      for (const std::size_t statistic : statistics_) {
        if (!has_cell(sequence)) break;
        PaperTable::Row row = error_row(quantity, sequence, statistic);
        for (const PublishedResult* result : printed) row.cells.push_back(printed_cell(*result, sequence, statistic));
        row.begins_group = is_first && !has_one_statistic();
        if (is_first) row.cells[0].text = plan_.matrix.sequences[sequence].name;
        is_first = false;
        table.rows.push_back(std::move(row));
      }
    }
    table.notes = {"Improvements in per cent: (baseline - value) / baseline. The smallest value of a row is bold."};
    if (quantity != Quantity::ate) table.notes.push_back("RPE over 1 s.");
    if (has_short_cell(table))
      table.notes.push_back("* Fewer than " + percent_text(100.0 * plan_.matrix.minimum_coverage, 0) +
                            " of the frames have a pose; such errors are not compared.");
    for (const PublishedResult* result : printed)
      table.notes.push_back(result->marked_system() + ": " + result->citation + "; " + result->protocol + ".");
    return table;
  }

  std::vector<PaperTable> published_rmse(const std::string& label) {
    if (published_.empty()) return {};
    PaperTable table;
    table.name = label + "_published";
    table.caption = "ATE RMSE [m], published figures as printed, and here" + count_text();
    table.text_columns = 1;
    table.header = {"System"};
    for (const MatrixSequence& sequence : plan_.matrix.sequences) table.header.push_back(sequence.name);
    std::vector<std::string> citations;
    for (const PublishedResult* result : published_) {
      auto citation = std::find(citations.begin(), citations.end(), result->citation);
      if (citation == citations.end()) citation = citations.insert(citations.end(), result->citation);
      const std::string number = "[" + std::to_string(citation - citations.begin() + 1) + "]";
      PaperTable::Row row{{{result->marked_system() + " " + number}}, false};
      for (std::size_t s = 0; s < plan_.matrix.sequences.size(); ++s) row.cells.push_back(printed_cell(*result, s, 0));
      table.rows.push_back(std::move(row));
    }
    for (const std::size_t variant : variants_) {
      PaperTable::Row row{{{column_name(variant) + " (here)"}}, variant == variants_.front()};
      for (std::size_t s = 0; s < plan_.matrix.sequences.size(); ++s) {
        const Cell* cell = analysis_.find(variant, s);
        row.cells.push_back(cell == nullptr ? PaperTable::Cell{no_figure} : value_cell(*cell, Quantity::ate, 0));
      }
      table.rows.push_back(std::move(row));
    }
    for (std::size_t i = 0; i < citations.size(); ++i)
      table.notes.push_back("[" + std::to_string(i + 1) + "] " + citations[i] + ".");
    table.notes.emplace_back(
        "Protocols, repeats and machines differ between papers. Sim(3) alignment fits a scale, too, so that these "
        "errors are not comparable with those after SE(3) alignment.");
    return {table};
  }

 private:
  bool has_one_statistic() const { return statistics_.size() == 1; }
  static std::string statistic_name(std::size_t statistic) { return printed_names[statistic]; }
  /// What the tables call a variant.
  std::string column_name(std::size_t variant) const {
    const std::string& name = plan_.variants[variant].name;
    for (const auto& [of_variant, column] : plan_.matrix.analysis.columns)
      if (of_variant.text == name) return column;
    return name;
  }
  bool has_cell(std::size_t sequence) const {
    return std::any_of(analysis_.cells.begin(), analysis_.cells.end(),
                       [&](const Cell& cell) { return cell.sequence == sequence; });
  }
  static bool has_short_cell(const PaperTable& table) {
    for (const PaperTable::Row& row : table.rows)
      if (std::any_of(row.cells.begin(), row.cells.end(), [](const auto& cell) { return cell.is_short; })) return true;
    return false;
  }
  bool is_of_these_sequences(const PublishedResult& result) const {
    return std::any_of(plan_.matrix.sequences.begin(), plan_.matrix.sequences.end(), [&](const MatrixSequence& each) {
      return result.values.contains(published_name(each)) || result.statistics.contains(published_name(each));
    });
  }
  std::vector<const PublishedResult*> printed_columns(Quantity quantity) const {
    std::vector<const PublishedResult*> columns;
    for (const PublishedResult* result : published_)
      if (quantity == Quantity::ate && result->has_more_than_rmse()) columns.push_back(result);
    return columns;
  }

  /// ", mean of 5 runs".
  std::string count_text() const {
    std::size_t least = 0, most = 0;
    for (const Cell& cell : analysis_.cells) {
      if (cell.counted == 0) continue;
      least = most == 0 ? cell.counted : std::min(least, cell.counted);
      most = std::max(most, cell.counted);
    }
    if (most == 0) return "";
    return ", mean of " +
           (least == most ? counted(most, "run") : std::to_string(least) + " to " + counted(most, "run"));
  }

  bool is_short(const Cell& cell) const { return cell.coverage.least < plan_.matrix.minimum_coverage; }
  static double mean_of(const Cell& cell, Quantity quantity, std::size_t statistic) {
    return cell.errors[static_cast<std::size_t>(quantity)][statistic].mean;
  }
  PaperTable::Cell value_cell(const Cell& cell, Quantity quantity, std::size_t statistic) const {
    const double mean = mean_of(cell, quantity, statistic);
    if (!std::isfinite(mean)) return {no_figure};
    return {fixed_text(mean, decimals_), false, is_short(cell)};
  }
  PaperTable::Cell printed_cell(const PublishedResult& result, std::size_t sequence, std::size_t statistic) const {
    const std::string& name = published_name(plan_.matrix.sequences[sequence]);
    const auto texts = result.printed.find(name);
    if (texts == result.printed.end() || texts->second[statistic].empty()) return {no_figure};
    return {texts->second[statistic]};
  }

  PaperTable::Row error_row(Quantity quantity, std::size_t sequence, std::size_t statistic) const {
    PaperTable::Row row{{{""}}, false};
    if (!has_one_statistic()) row.cells.push_back({statistic_name(statistic)});
    double best = Statistics::none;
    std::size_t candidates = 0;
    for (const std::size_t variant : variants_) {
      const Cell* cell = analysis_.find(variant, sequence);
      if (cell == nullptr || is_short(*cell) || !std::isfinite(mean_of(*cell, quantity, statistic))) continue;
      ++candidates;
      best = std::isfinite(best) ? std::min(best, mean_of(*cell, quantity, statistic))
                                 : mean_of(*cell, quantity, statistic);
    }
    const std::string best_text = candidates > 1 ? fixed_text(best, decimals_) : "";
    for (const std::size_t variant : variants_) {
      const Cell* cell = analysis_.find(variant, sequence);
      row.cells.push_back(cell == nullptr ? PaperTable::Cell{no_figure} : value_cell(*cell, quantity, statistic));
      PaperTable::Cell& added = row.cells.back();
      added.is_best = !added.is_short && added.text == best_text;
      if (!plan_.variants[variant].baseline) continue;
      const Cell* before = analysis_.find(*plan_.variants[variant].baseline, sequence);
      const double percent =
          cell == nullptr || before == nullptr
              ? Statistics::none
              : improvement_percent(mean_of(*before, quantity, statistic), mean_of(*cell, quantity, statistic));
      row.cells.push_back({percent_text(percent, 2)});
    }
    return row;
  }

  const RunPlan& plan_;
  const Analysis& analysis_;
  int decimals_;
  std::vector<std::size_t> variants_;
  std::vector<std::size_t> statistics_;  ///< rows of a sequence
  std::vector<const PublishedResult*> published_;
};

}  // namespace

const std::vector<std::string>& paper_table_names() {
  static const std::vector<std::string> names = {"paper2", "paper3"};
  return names;
}

void add_paper_table(const std::string& name, MatrixAnalysis& analysis) {
  if (std::find(analysis.tables.begin(), analysis.tables.end(), name) == analysis.tables.end())
    analysis.tables.push_back(name);
}

std::vector<std::string> table_statistic_names() {
  std::vector<std::string> names;
  for (const std::size_t statistic : printed_order) names.emplace_back(statistic_keys[statistic]);
  return names;
}

void add_table_statistic(const PlacedText& name, MatrixAnalysis& analysis, std::vector<Diagnostic>& diagnostics) {
  const auto found = std::find(statistic_keys.begin(), statistic_keys.end(), name.text);
  if (found == statistic_keys.end())
    diagnostics.push_back({name.location, "there is no statistic '" + name.text + "'; " +
                                              did_you_mean(name.text, table_statistic_names())});
  else
    analysis.statistics.push_back(static_cast<std::size_t>(found - statistic_keys.begin()));
}

std::vector<PaperTable> paper_tables(const std::string& name, const RunPlan& plan, const Analysis& analysis,
                                     const PublishedResults& published) {
  PaperTableMaker maker(plan, analysis, published);
  if (name == "paper2") {
    std::vector<PaperTable> tables = {maker.errors(name, Quantity::ate)};
    for (PaperTable& table : maker.published_rmse(name)) tables.push_back(std::move(table));
    return tables;
  }
  return {maker.errors(name + "_translation", Quantity::rpe_translation),
          maker.errors(name + "_rotation", Quantity::rpe_rotation)};
}

ReportTable paper_figures(const std::string& name, const RunPlan& plan, const Analysis& analysis) {
  const auto text = [](double value) { return std::isfinite(value) ? shortest_text(value) : ""; };
  ReportTable table{"",
                    {"quantity", "unit", "sequence", "statistic", "variant", "runs", "coverage_least", "mean",
                     "baseline", "improvement_percent"},
                    {},
                    {}};
  for (const Quantity quantity : quantities_of(name))
    for (const Cell& cell : analysis.cells)
      for (const std::size_t s : printed_order) {
        const Variant& variant = plan.variants[cell.variant];
        const auto mean_of = [&](const Cell& of) { return of.errors[static_cast<std::size_t>(quantity)][s].mean; };
        const Cell* before = variant.baseline ? analysis.find(*variant.baseline, cell.sequence) : nullptr;
        table.rows.push_back({to_string(quantity), unit_of(quantity), plan.matrix.sequences[cell.sequence].name,
                              printed_names[s], variant.name, std::to_string(cell.counted), text(cell.coverage.least),
                              text(mean_of(cell)), before != nullptr ? plan.variants[before->variant].name : "",
                              before != nullptr ? text(improvement_percent(mean_of(*before), mean_of(cell))) : ""});
      }
  return table;
}

}  // namespace holdfast
