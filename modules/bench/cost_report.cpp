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
  std::vector<double> tracking, per_frame, processor, ratio, memory, others;
  bool alone = true;
};

ReportTable by_variant(const RunPlan& plan, const Analysis& analysis) {
  ReportTable table{
      "",
      {"variant", "tracking, median [ms a frame]", "whole process [ms a frame]", "processor time [s a run]",
       "processor / wall", "peak memory [MB]", "processors used by others, most", "alone"},
      {},
      {}};
  for (std::size_t i = 0; i < plan.variants.size(); ++i) {
    VariantCost cost;
    for (const Cell& cell : analysis.cells) {
      if (cell.variant != i) continue;
      cost.ratio.push_back(cell.processor_ratio.median);
      cost.others.push_back(cell.other_processors.most);
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
                          scaled(spread_of(cost.ratio).median, 1.0, 2), scaled(spread_of(cost.memory).most, 1e-6, 0),
                          scaled(spread_of(cost.others).most, 1.0, 2), cost.alone ? "yes" : "no"});
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

/// Whether times can be trusted: runs that had company, from this bench or from other programs.
std::string company_text(const BenchResults& results) {
  std::size_t runs = 0, beside = 0, disturbed = 0;
  std::vector<double> loads, others;
  for (const auto& cost : results.costs) {
    if (!cost) continue;
    ++runs;
    beside += cost->alone ? 0 : 1;
    disturbed += cost->is_undisturbed() ? 0 : 1;
    loads.push_back(cost->load_average);
    others.push_back(cost->other_processors);
  }
  if (runs == 0) return "";
  std::string text;
  if (beside > 0)
    text += "**" + counted(beside, "run") + " of " + std::to_string(runs) +
            " had other runs of this bench beside them**, which disturbs times: `timing: true` executes one at a "
            "time.\n";
  if (disturbed > beside)
    text += "**" + counted(disturbed - beside, "run") + " of " + std::to_string(runs) +
            " had other programs beside them**, which kept up to " + fixed_text(spread_of(others).most, 2) +
            " processors busy: times are disturbed. Repeat them on an idle machine.\n";
  if (disturbed == 0)
    text += spread_of(others).count > 0
                ? "Every run was alone: no other run of this bench, and other programs used at most " +
                      fixed_text(spread_of(others).most, 2) + " processors.\n"
                : "No other run of this bench was beside a run; what other programs did is not known.\n";
  if (const Spread load = spread_of(loads); load.count > 0)
    text += "Load average when runs began: " + fixed_text(load.median, 2) + " (" + fixed_text(load.least, 2) + " to " +
            fixed_text(load.most, 2) + ").\n";
  return text + "\n";
}

/// Costs of every kind of machine of its own, where there are several.
std::string by_machine(const RunPlan& plan, const BenchResults& results, const std::set<std::string>& machines) {
  std::string text;
  for (const std::string& machine : machines) {
    BenchResults of_machine = results;
    for (std::size_t i = 0; i < plan.runs.size(); ++i)
      if (of_machine.costs[i] && of_machine.costs[i]->machine != machine)
        of_machine.results[i].reset(), of_machine.costs[i].reset();
    text += (machines.size() > 1 ? "### " + markdown_text(machine) + "\n\n" : std::string()) +
            to_markdown(by_variant(plan, analyse(plan, of_machine))) + "\n";
  }
  return text;
}

}  // namespace

std::string cost_report(const RunPlan& plan, const BenchResults& results, const Analysis& analysis,
                        const PublishedResults& published) {
  std::set<std::string> machines, versions, levels;
  for (const auto& cost : results.costs) {
    if (!cost) continue;
    if (!cost->machine.empty()) machines.insert(cost->machine);
    if (!cost->version.empty()) versions.insert(cost->version);
    if (!cost->simd.empty()) levels.insert(cost->simd);
  }
  std::string text = "# " + markdown_text(plan.matrix.title) + ": time and memory\n\n";
  if (!machines.empty()) text += "Machine: " + listed(machines) + ".\n";
  if (!versions.empty()) text += "Holdfast: " + listed(versions) + ".\n";
  if (!levels.empty()) text += "SIMD level of Holdfast: " + listed(levels) + ".\n";
  if (versions.size() > 1) text += "**Runs of several versions stand side by side**: begin a new folder.\n";
  if (levels.size() > 1) text += "**Runs of Holdfast used several SIMD levels**: their times differ.\n";
  if (machines.size() > 1)
    text += "**Runs were executed on " + std::to_string(machines.size()) +
            " kinds of machine**: times are compared within one only.\n";
  text += company_text(results);
  text +=
      "Medians over runs and sequences; the memory is the most of all runs. `tracking` is what the program itself "
      "measured from the images to the pose; the whole process has everything in it, from its start to its last "
      "file.\n\n" +
      (machines.empty() ? to_markdown(by_variant(plan, analysis)) + "\n" : by_machine(plan, results, machines));
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
