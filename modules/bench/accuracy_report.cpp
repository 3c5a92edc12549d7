// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "holdfast/bench/bench_report.hpp"
#include "holdfast/bench/error_text.hpp"
#include "holdfast/bench/robustness.hpp"
#include "holdfast/bench/tables.hpp"

namespace holdfast {

namespace {

std::string metres(double value) { return error_text(value); }
std::string percent(double share) { return percent_text(100.0 * share, 2); }
std::string plural(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

class AccuracyReport {
 public:
  AccuracyReport(const RunPlan& plan, const BenchResults& results, const Analysis& analysis,
                 const PublishedResults& published)
      : plan_(plan), results_(results), analysis_(analysis), published_(published) {}

  std::string text() {
    text_ = "# " + markdown_text(plan_.matrix.title) + "\n\n";
    if (!plan_.matrix.about.empty()) text_ += markdown_text(plan_.matrix.about) + "\n\n";
    add_counts();
    add_comparisons();
    add_variants();
    add_cells();
    add_improvements();
    add_robustness();
    add_published();
    add_trouble();
    add_method();
    return text_;
  }

 private:
  const std::string& variant(std::size_t i) const { return plan_.variants[i].name; }
  const std::string& sequence(std::size_t i) const { return plan_.matrix.sequences[i].name; }

  void add(const ReportTable& table) { text_ += to_markdown(table) + "\n"; }

  void add_counts() {
    std::size_t done = 0, counted = 0;
    for (const auto& result : results_.results) {
      done += result ? 1 : 0;
      counted += result && result->counts() ? 1 : 0;
    }
    text_ += std::to_string(done) + " of " + plural(plan_.runs.size(), "run") + " done, " + std::to_string(counted) +
             " with a result that counts: " + plural(plan_.variants.size(), "variant") + ", " +
             plural(plan_.matrix.sequences.size(), "sequence") + ". Time and memory: [cost.md](cost.md).";
    for (const std::string& name : plan_.matrix.analysis.tables) text_ += " [" + name + "](tables/" + name + ".md).";
    text_ += "\n\n";
    if (done < plan_.runs.size()) text_ += "**Unfinished**: what follows is about the runs that are done.\n\n";
  }

  void add_comparisons() {
    if (analysis_.comparisons.empty()) return;
    text_ += "## What helps, by how much, and is it sure?\n\n";
    for (const Comparison& comparison : analysis_.comparisons)
      if (comparison.quantity == Quantity::ate) text_ += "- " + sentence(plan_, comparison) + "\n";
    text_ += "\n";
    ReportTable table{"",
                      {"variant", "against", "error", "better on", "gain, median", "gain", "95 % interval of the gain",
                       "p", "p (Holm)", "verdict"},
                      {},
                      {}};
    for (const Comparison& c : analysis_.comparisons) {
      const std::string unit = std::string(" ") + unit_of(c.quantity);
      const bool has_pairs = !c.sequences.empty();
      table.rows.push_back({variant(c.after), variant(c.before), to_string(c.quantity),
                            std::to_string(c.better) + " of " + std::to_string(c.sequences.size()),
                            has_pairs ? error_text(c.gain) + unit : "-", percent_text(c.gain_percent, 1),
                            c.enough ? error_text(c.interval.low) + " to " + error_text(c.interval.high) + unit : "-",
                            c.enough ? probability_text(c.test.p) : "-", c.enough ? probability_text(c.adjusted) : "-",
                            c.verdict()});
    }
    add(table);
  }

  /// Whether the errors on a sequence are those against a transformed truth.
  bool has_transformed_truth(std::size_t sequence) const {
    for (std::size_t i = 0; i < plan_.runs.size(); ++i)
      if (const auto& result = results_.results[i]; plan_.runs[i].sequence == sequence && result && result->has_errors)
        return result->truth_frame != "raw";
    return false;
  }
  /// The truth that the errors refer to, and on which sequences.
  std::string truth_sentence() const {
    std::string names;
    for (std::size_t s = 0; s < plan_.matrix.sequences.size(); ++s)
      if (has_transformed_truth(s)) names += (names.empty() ? "" : ", ") + sequence(s);
    if (names.empty()) return "Truth: raw, as recorded.";
    return "Truth: transformed from markers to the camera (`source.tum.truth_frame`, `truth_left`, `truth_right`) on " +
           names + "; elsewhere raw, as recorded. Published ATE is against the raw truth.";
  }

  void add_variants() {
    text_ += "## Variants\n\nATE RMSE [m] over sequences, each the median over its runs.\n\n";
    ReportTable table{
        "", {"variant", "sequences", "runs that count", "median", "least", "most", "coverage, least"}, {}, {}};
    for (std::size_t i = 0; i < plan_.variants.size(); ++i) {
      std::vector<double> errors, coverages;
      std::size_t runs = 0, counted = 0;
      for (const Cell& cell : analysis_.cells) {
        if (cell.variant != i) continue;
        errors.push_back(cell.error(Quantity::ate));
        coverages.push_back(cell.coverage.least);
        runs += cell.runs.size();
        counted += cell.counted;
      }
      if (runs == 0) continue;
      const Spread spread = spread_of(errors);
      table.rows.push_back({variant(i), std::to_string(spread.count),
                            std::to_string(counted) + " of " + std::to_string(runs), metres(spread.median),
                            metres(spread.least), metres(spread.most), percent(spread_of(coverages).least)});
    }
    add(table);
  }

  void add_cells() {
    for (const Quantity quantity : all_quantities) {
      text_ += std::string("## ") + to_string(quantity) + " RMSE [" + unit_of(quantity) +
               "]\n\nMedian over runs (least to most where there are several)" +
               (quantity == Quantity::ate ? ", coverage where it is below 100 %" : "") + ". " + truth_sentence() +
               "\n\n";
      ReportTable table = by_sequence([&](const Cell& cell) {
        const Spread& spread = cell.errors[static_cast<std::size_t>(quantity)][0];
        std::string text = metres(spread.median);
        if (spread.count > 1 && spread.least < spread.most)
          text += " (" + metres(spread.least) + " to " + metres(spread.most) + ")";
        if (cell.counted < cell.runs.size())
          text += ", " + std::to_string(cell.runs.size() - cell.counted) + " of " + std::to_string(cell.runs.size()) +
                  " without a figure";
        if (quantity == Quantity::ate && cell.coverage.least < 1.0) text += ", " + percent(cell.coverage.least);
        return text;
      });
      add(table);
    }
  }

  template <class Text>
  ReportTable by_sequence(const Text& text_of_cell) const {
    ReportTable table{"", {"sequence"}, {}, {}};
    std::vector<std::size_t> columns;
    for (std::size_t i = 0; i < plan_.variants.size(); ++i) {
      columns.push_back(i);
      table.header.push_back(variant(i));
    }
    for (std::size_t s = 0; s < plan_.matrix.sequences.size(); ++s) {
      std::vector<std::string> row = {sequence(s) + (has_transformed_truth(s) ? " (transformed truth)" : "")};
      for (const std::size_t column : columns) {
        const Cell* cell = analysis_.find(column, s);
        row.push_back(cell != nullptr ? text_of_cell(*cell) : "");
      }
      table.rows.push_back(std::move(row));
    }
    return table;
  }

  void add_improvements() {
    if (analysis_.improvements.empty()) return;
    text_ +=
        "## Improvements over the baseline\n\nEach cell: baseline to variant, and (baseline - variant) / baseline in "
        "per cent, as tables 2 and 3 of Zeng et al. 2023.\n\n";
    for (std::size_t q = 0; q < all_quantities.size(); ++q)
      for (std::size_t i = 0; i < plan_.variants.size(); ++i) {
        ReportTable table{"", {"sequence"}, {}, {}};
        for (const char* name : statistic_names) table.header.emplace_back(name);
        for (const Improvement& improvement : analysis_.improvements)
          if (improvement.variant == i) table.rows.push_back(improvement_row(improvement, q));
        if (table.rows.empty()) continue;
        text_ += std::string("### ") + to_string(all_quantities[q]) + " [" + unit_of(all_quantities[q]) + "]: `" +
                 variant(*plan_.variants[i].baseline) + "` and `" + variant(i) + "`\n\n";
        add(table);
      }
  }

  std::vector<std::string> improvement_row(const Improvement& improvement, std::size_t q) const {
    std::vector<std::string> row = {sequence(improvement.sequence)};
    for (std::size_t s = 0; s < statistic_names.size(); ++s) {
      const double change = improvement.percent[q][s];
      row.push_back(std::isfinite(improvement.after[q][s])
                        ? metres(improvement.before[q][s]) + " to " + metres(improvement.after[q][s]) + ": " +
                              percent_text(change, 2)
                        : "-");
    }
    return row;
  }

  void add_robustness() {
    const std::vector<RobustnessCurve> curves = robustness_curves(plan_, analysis_);
    if (curves.empty()) return;
    text_ +=
        "## Robustness\n\nATE RMSE [m], the median over sequences, and coverage, the mean over sequences, by strength "
        "of "
        "what was made worse about the frames. Plots: `robustness/`.\n\n" +
        robustness_text(curves);
  }

  void add_published() {
    ReportTable table{"", {"system"}, {}, {}};
    for (const MatrixSequence& each : plan_.matrix.sequences) table.header.push_back(each.name);
    table.header.insert(table.header.end(), {"source", "protocol"});
    for (const PublishedResult& result : published_.results) {
      std::vector<std::string> row = {result.marked_system()};
      bool has_value = false;
      for (const MatrixSequence& each : plan_.matrix.sequences) {
        const auto value = result.values.find(published_name(each));
        has_value = has_value || value != result.values.end();
        row.push_back(value != result.values.end() ? metres(value->second) : "");
      }
      row.insert(row.end(), {result.citation, result.protocol});
      if (has_value) table.rows.push_back(std::move(row));
    }
    if (table.rows.empty()) return;
    text_ +=
        "## Published figures\n\nATE RMSE [m] as printed. The same system differs between papers: protocols, repeats "
        "and machines differ, so these are a scale, not opponents. " +
        truth_sentence() + "\n\n";
    for (std::size_t i = 0; i < plan_.variants.size(); ++i) {
      std::vector<std::string> row = {"**" + variant(i) + "** (here)"};
      for (std::size_t s = 0; s < plan_.matrix.sequences.size(); ++s) {
        const Cell* cell = analysis_.find(i, s);
        row.push_back(cell != nullptr ? metres(cell->error(Quantity::ate)) : "");
      }
      row.insert(row.end(), {"this report", "SE(3), median over runs"});
      table.rows.insert(table.rows.begin() + static_cast<std::ptrdiff_t>(i), std::move(row));
    }
    add(table);
  }

  void add_trouble() {
    ReportTable table{"", {"run", "what became of it", "coverage", "ATE RMSE of what there is [m]"}, {}, {}};
    for (std::size_t i = 0; i < plan_.runs.size(); ++i) {
      if (!results_.results[i]) continue;
      const RunResult& result = *results_.results[i];
      const bool is_short = result.coverage() < plan_.matrix.minimum_coverage;
      if (result.counts() && !is_short && result.not_finite == 0 && result.malformed == 0) continue;
      table.rows.push_back({plan_.runs[i].id, outcome_text(result) + (is_short ? ", short" : ""),
                            percent(result.coverage()), result.has_errors ? metres(result.errors[0][0]) : "-"});
    }
    if (table.rows.empty()) return;
    text_ += "## Trouble\n\nRuns that did not finish, have no figures, have fewer than " +
             percent(plan_.matrix.minimum_coverage) +
             " of the poses, or left what is no pose. Of these only runs that finished enter the tables above.\n\n";
    add(table);
  }

  void add_method() {
    text_ +=
        "## How this was measured\n\nSE(3) alignment over all pairs, stamps paired one to one within 0.02 s; RPE over "
        "1 s; coverage is frames with a pose / colour-depth pairs. Tests: Wilcoxon's signed-rank test over "
        "sequences, exact, two-sided, on the medians over runs; interval: percentile bootstrap of the median gain, "
        "10,000 draws, fixed seed; fewer than " +
        std::to_string(fewest_pairs_to_test) + " pairs are not tested.";
    if (plan_.matrix.mode) text_ += " Mode: " + markdown_text(plan_.matrix.mode->text) + ".";
    text_ += "\n";
  }

  const RunPlan& plan_;
  const BenchResults& results_;
  const Analysis& analysis_;
  const PublishedResults& published_;
  std::string text_;
};

}  // namespace

std::string accuracy_report(const RunPlan& plan, const BenchResults& results, const Analysis& analysis,
                            const PublishedResults& published) {
  return AccuracyReport(plan, results, analysis, published).text();
}

}  // namespace holdfast
