// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/analysis.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "holdfast/bench/error_text.hpp"

namespace holdfast {

namespace {

Cell make_cell(const RunPlan& plan, const BenchResults& results, std::size_t variant, std::size_t sequence) {
  Cell cell;
  cell.variant = variant;
  cell.sequence = sequence;
  std::vector<double> coverage, wall, processor, tracking, per_frame, memory, ratios, others, loads;
  std::array<std::array<std::vector<double>, 6>, 3> errors;
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    if (plan.runs[i].variant != variant || plan.runs[i].sequence != sequence || !results.results[i]) continue;
    const RunResult& result = *results.results[i];
    const RunCost& cost = *results.costs[i];
    cell.runs.push_back(i);
    coverage.push_back(result.coverage());
    cell.alone = cell.alone && cost.is_undisturbed();
    others.push_back(cost.other_processors);
    loads.push_back(cost.load_average);
    if (!result.counts()) continue;
    ++cell.counted;
    for (std::size_t q = 0; q < errors.size(); ++q)
      for (std::size_t s = 0; s < errors[q].size(); ++s) errors[q][s].push_back(result.errors[q][s]);
    wall.push_back(cost.process.wall_seconds);
    processor.push_back(cost.process.user_seconds + cost.process.system_seconds);
    tracking.push_back(cost.tracking);
    ratios.push_back(cost.processor_ratio());
    per_frame.push_back(cost.process.wall_seconds / static_cast<double>(result.frames));
    memory.push_back(static_cast<double>(cost.process.peak_memory));
  }
  for (std::size_t q = 0; q < errors.size(); ++q)
    for (std::size_t s = 0; s < errors[q].size(); ++s) cell.errors[q][s] = spread_of(errors[q][s]);
  cell.coverage = spread_of(coverage);
  cell.wall = spread_of(wall);
  cell.processor = spread_of(processor);
  cell.tracking = spread_of(tracking);
  cell.wall_per_frame = spread_of(per_frame);
  cell.memory = spread_of(memory);
  cell.processor_ratio = spread_of(ratios);
  cell.other_processors = spread_of(others);
  cell.load_average = spread_of(loads);
  return cell;
}

Improvement improvement(const Cell& before, const Cell& after) {
  Improvement result{after.variant, before.variant, after.sequence, {}, {}, {}};
  for (std::size_t q = 0; q < result.before.size(); ++q)
    for (std::size_t s = 0; s < result.before[q].size(); ++s) {
      result.before[q][s] = before.errors[q][s].median;
      result.after[q][s] = after.errors[q][s].median;
      result.percent[q][s] = 100.0 * (result.before[q][s] - result.after[q][s]) / result.before[q][s];
    }
  return result;
}

Comparison compare(const RunPlan& plan, const Analysis& analysis, std::size_t before, std::size_t after,
                   Quantity quantity) {
  Comparison result;
  result.before = before;
  result.after = after;
  result.quantity = quantity;
  std::vector<double> gains, percents;
  for (std::size_t sequence = 0; sequence < plan.matrix.sequences.size(); ++sequence) {
    const Cell *first = analysis.find(before, sequence), *second = analysis.find(after, sequence);
    if (first == nullptr && second == nullptr) continue;
    if (first == nullptr || second == nullptr || !std::isfinite(first->error(quantity)) ||
        !std::isfinite(second->error(quantity))) {
      ++result.left_out;
      continue;
    }
    const double gain = first->error(quantity) - second->error(quantity);
    result.sequences.push_back(sequence);
    gains.push_back(gain);
    percents.push_back(100.0 * gain / first->error(quantity));
    result.better += gain > 0.0 ? 1 : 0;
    result.worse += gain < 0.0 ? 1 : 0;
    result.least_coverage_before = std::min(result.least_coverage_before, first->coverage.least);
    result.least_coverage_after = std::min(result.least_coverage_after, second->coverage.least);
  }
  if (gains.empty()) return result;
  result.gain = median(gains);
  result.gain_percent = spread_of(percents).median;  // a baseline without any error has none
  result.test = wilcoxon_signed_rank(gains);
  result.enough = result.test.pairs >= fewest_pairs_to_test;
  if (result.enough) result.interval = bootstrap_median(gains);
  return result;
}

/// Each quantity is one question; the comparisons of a question are its tests.
void adjust(std::vector<Comparison>& comparisons) {
  for (const Quantity quantity : all_quantities) {
    std::vector<Comparison*> tests;
    std::vector<double> p_values;
    for (Comparison& comparison : comparisons)
      if (comparison.quantity == quantity && comparison.enough) {
        tests.push_back(&comparison);
        p_values.push_back(comparison.test.p);
      }
    const std::vector<double> adjusted = holm_adjusted(p_values);
    for (std::size_t i = 0; i < tests.size(); ++i) tests[i]->adjusted = adjusted[i];
  }
}

}  // namespace

Spread spread_of(const std::vector<double>& values) {
  std::vector<double> numbers;
  for (const double value : values)
    if (!std::isnan(value)) numbers.push_back(value);
  if (numbers.empty()) return {};
  const auto [least, most] = std::minmax_element(numbers.begin(), numbers.end());
  const double mean = std::accumulate(numbers.begin(), numbers.end(), 0.0) / static_cast<double>(numbers.size());
  return {median(numbers), *least, *most, numbers.size(), mean};
}

const Cell* Analysis::find(std::size_t variant, std::size_t sequence) const {
  for (const Cell& cell : cells)
    if (cell.variant == variant && cell.sequence == sequence) return &cell;
  return nullptr;
}

Analysis analyse(const RunPlan& plan, const BenchResults& results) {
  Analysis analysis;
  for (std::size_t sequence = 0; sequence < plan.matrix.sequences.size(); ++sequence)
    for (std::size_t variant = 0; variant < plan.variants.size(); ++variant) {
      Cell cell = make_cell(plan, results, variant, sequence);
      if (!cell.runs.empty()) analysis.cells.push_back(std::move(cell));
    }
  for (std::size_t variant = 0; variant < plan.variants.size(); ++variant)
    for (const Cell& cell : analysis.cells) {
      if (cell.variant != variant || !plan.variants[variant].baseline) continue;
      if (const Cell* before = analysis.find(*plan.variants[variant].baseline, cell.sequence))
        analysis.improvements.push_back(improvement(*before, cell));
    }
  for (const Quantity quantity : all_quantities)
    for (const auto& [before, after] : plan.comparisons)
      analysis.comparisons.push_back(compare(plan, analysis, before, after, quantity));
  adjust(analysis.comparisons);
  return analysis;
}

std::string sentence(const RunPlan& plan, const Comparison& c) {
  const std::string before = "`" + plan.variants[c.before].name + "`", after = "`" + plan.variants[c.after].name + "`";
  const std::string unit = std::string(" ") + unit_of(c.quantity);
  const std::size_t pairs = c.sequences.size();
  std::string text = after + " against " + before + ": ";
  if (pairs == 0) return text + "too few to tell, no sequence on which both have a figure.";
  const bool is_gain = c.gain >= 0.0;
  text += std::string(is_gain ? "smaller" : "larger") + " " + to_string(c.quantity) + " RMSE on " +
          std::to_string(is_gain ? c.better : c.worse) + " of " + counted(pairs, "sequence") + ", by " +
          error_text(std::abs(c.gain)) + unit + " (median of the differences; of the ratios " +
          percent_text(is_gain ? c.gain_percent : -c.gain_percent, 1) + "). ";
  if (!c.enough) {
    text += "Too few to tell: " + counted(c.test.pairs, "pair") + " that differ" + (c.test.pairs == 1 ? "s" : "") +
            ", " + std::to_string(fewest_pairs_to_test) + " are needed.";
  } else {
    const std::string numbers = p_text(c.test.p) + ", " + counted(c.test.pairs, "pair") +
                                "; 95 % interval of the gain " + error_text(c.interval.low) + " to " +
                                error_text(c.interval.high) + unit;
    if (!c.is_significant())
      text += "The difference is not significant (" + numbers + "): these sequences do not tell which is better.";
    else
      text +=
          "The difference is significant (" + numbers + ")" +
          (c.adjusted < 0.05 ? ""
                             : "; with Holm's correction for all comparisons it is not (" + p_text(c.adjusted) + ")") +
          ".";
  }
  if (c.left_out > 0) text += " " + counted(c.left_out, "sequence") + " left out, where one of them has no figure.";
  const double least = std::min(c.least_coverage_before, c.least_coverage_after);
  if (least < plan.matrix.minimum_coverage)
    text += " Coverage falls to " + fixed_text(100.0 * least, 1) + " % (" +
            (c.least_coverage_after <= c.least_coverage_before ? after : before) +
            "): errors over fewer frames are not the same errors.";
  return text;
}

}  // namespace holdfast
