// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <set>

#include "holdfast/bench/bench_report.hpp"
#include "holdfast/bench/tables.hpp"
#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

namespace {

std::string scaled(double value, double factor, int decimals) {
  return std::isfinite(value) ? fixed_text(value * factor, decimals) : "-";
}

/// What all runs say alike, or what they say differently.
std::string listed(const std::set<std::string>& texts) {
  std::string text;
  for (const std::string& each : texts) text += (text.empty() ? "" : "; ") + markdown_text(each);
  return text;
}

/// Medians over the runs of a variant.
struct VariantCost {
  std::vector<double> tracking, per_frame, processor, memory;
  bool alone = true;
};

ReportTable by_variant(const RunPlan& plan, const Analysis& analysis) {
  ReportTable table{"",
                    {"variant", "tracking, median [ms a frame]", "whole process [ms a frame]",
                     "processor time [s a run]", "peak memory [MB]", "alone"},
                    {},
                    {}};
  for (std::size_t i = 0; i < plan.variants.size(); ++i) {
    VariantCost cost;
    for (const Cell& cell : analysis.cells) {
      if (cell.variant != i) continue;
      cost.tracking.push_back(cell.tracking.median);
      cost.per_frame.push_back(cell.wall_per_frame.median);
      cost.processor.push_back(cell.processor.median);
      cost.memory.push_back(cell.memory.most);
      cost.alone = cost.alone && cell.alone;
    }
    if (cost.memory.empty()) continue;
    table.rows.push_back({plan.variants[i].name, scaled(spread_of(cost.tracking).median, 1e3, 2),
                          scaled(spread_of(cost.per_frame).median, 1e3, 1),
                          scaled(spread_of(cost.processor).median, 1.0, 1),
                          scaled(spread_of(cost.memory).most, 1e-6, 0), cost.alone ? "yes" : "no"});
  }
  return table;
}

ReportTable stages(const RunPlan& plan, const BenchResults& results) {
  std::vector<std::string> names;
  for (const auto& cost : results.costs)
    if (cost)
      for (const StageCost& stage : cost->stages)
        if (std::find(names.begin(), names.end(), stage.name) == names.end()) names.push_back(stage.name);
  ReportTable table{"", {"stage"}, {}, {}};
  for (const Variant& variant : plan.variants)
    if (!variant.is_external()) table.header.push_back(variant.name);
  for (const std::string& name : names) {
    std::vector<std::string> row = {name};
    for (std::size_t v = 0; v < plan.variants.size(); ++v) {
      if (plan.variants[v].is_external()) continue;
      std::vector<double> medians;
      for (std::size_t i = 0; i < plan.runs.size(); ++i) {
        if (plan.runs[i].variant != v || !results.costs[i]) continue;
        for (const StageCost& stage : results.costs[i]->stages)
          if (stage.name == name) medians.push_back(stage.median);
      }
      row.push_back(medians.empty() ? "" : scaled(spread_of(medians).median, 1e3, 2));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::string cost_report(const RunPlan& plan, const BenchResults& results, const Analysis& analysis,
                        const PublishedResults& published) {
  std::set<std::string> machines, versions;
  for (const auto& cost : results.costs) {
    if (!cost) continue;
    if (!cost->machine.empty()) machines.insert(cost->machine);
    if (!cost->version.empty()) versions.insert(cost->version);
  }
  const bool all_alone =
      std::all_of(analysis.cells.begin(), analysis.cells.end(), [](const Cell& cell) { return cell.alone; });
  std::string text = "# " + markdown_text(plan.matrix.title) + ": time and memory\n\n";
  if (!machines.empty()) text += "Machine: " + listed(machines) + ".\n";
  if (!versions.empty()) text += "Holdfast: " + listed(versions) + ".\n";
  if (versions.size() > 1) text += "**Runs of several versions stand side by side**: begin a new folder.\n";
  text += all_alone
              ? "Every run stood alone: no other one of this bench ran beside it.\n\n"
              : "**Some runs had others beside them**, which disturbs times: `timing: true` has each stand alone.\n\n";
  text +=
      "Medians over runs and sequences; the memory is the most of all runs. `tracking` is what the program itself "
      "measured from the images to the pose; the whole process has everything in it, from its start to its last "
      "file.\n\n" +
      to_markdown(by_variant(plan, analysis)) + "\n";
  const ReportTable stage_table = stages(plan, results);
  if (!stage_table.rows.empty())
    text += "## Stages\n\nMedian over the frames in which a stage ran [ms], median over runs.\n\n" +
            to_markdown(stage_table) + "\n";
  for (const PublishedTimes& times : published.times) {
    ReportTable table{"", {"system", "time per frame / ORB-SLAM2's"}, {}, {}};
    for (const auto& [system, ratio] : times.ratios) table.rows.push_back({system, fixed_text(ratio, 2)});
    text += "## Published: " + times.citation + "\n\n" + times.protocol + ".\n\n" + to_markdown(table) + "\n";
  }
  return text;
}

}  // namespace holdfast
