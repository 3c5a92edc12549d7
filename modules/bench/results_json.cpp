// SPDX-License-Identifier: BSD-3-Clause
#include <nlohmann/json.hpp>

#include "error_keys.hpp"
#include "holdfast/bench/bench_report.hpp"
#include "holdfast/bench/paper_tables.hpp"
#include "holdfast/bench/report_page.hpp"
#include "holdfast/bench/robustness.hpp"
#include "holdfast/bench/tables.hpp"
#include "holdfast/core/trajectory.hpp"

namespace holdfast {

namespace {

using Json = nlohmann::ordered_json;

Json spread_json(const Spread& spread) {
  return {{"median", spread.median}, {"least", spread.least}, {"most", spread.most}, {"count", spread.count}};
}

Json six_json(const SixStatistics& values) {
  Json json;
  for (std::size_t s = 0; s < values.size(); ++s) json[statistic_keys[s]] = values[s];
  return json;
}

Json run_json(const RunPlan& plan, const BenchResults& results, std::size_t i) {
  const PlannedRun& run = plan.runs[i];
  const bool is_external = plan.variants[run.variant].is_external();
  Json json = {{"id", run.id},
               {"variant", run.variant},
               {"sequence", run.sequence},
               {"seed", run.seed},
               {"repeat", run.repeat},
               {"folder", "runs/" + run.id},
               {"configuration", is_external ? external_request_file : configuration_file}};
  json["result"] = results.results[i] ? Json::parse(to_json(*results.results[i])) : Json(nullptr);
  json["counts"] = results.results[i] && results.results[i]->counts();
  json["outcome"] = results.results[i] ? outcome_text(*results.results[i]) : "not done";
  const bool has_tracks = results.results[i] && results.results[i]->has_errors;
  json["tracks"] = has_tracks ? Json("runs/" + run.id + "/tracks.json") : Json(nullptr);
  json["report"] = is_external ? Json(nullptr) : Json("runs/" + run.id + "/report.html");
  json["cost"] = results.costs[i] ? Json::parse(to_json(*results.costs[i])) : Json(nullptr);
  return json;
}

Json cell_json(const Cell& cell) {
  Json json = {{"variant", cell.variant},
               {"sequence", cell.sequence},
               {"runs", cell.runs},
               {"counted", cell.counted},
               {"coverage", spread_json(cell.coverage)}};
  for (std::size_t q = 0; q < quantity_keys.size(); ++q)
    for (std::size_t s = 0; s < statistic_keys.size(); ++s)
      json["errors"][quantity_keys[q]][statistic_keys[s]] = spread_json(cell.errors[q][s]);
  json["cost"] = {{"wall_s", spread_json(cell.wall)},
                  {"processor_s", spread_json(cell.processor)},
                  {"tracking_s", spread_json(cell.tracking)},
                  {"wall_per_frame_s", spread_json(cell.wall_per_frame)},
                  {"peak_memory_bytes", spread_json(cell.memory)},
                  {"processor_ratio", spread_json(cell.processor_ratio)},
                  {"other_processors", spread_json(cell.other_processors)},
                  {"load_average", spread_json(cell.load_average)},
                  {"alone", cell.alone}};
  return json;
}

Json improvement_json(const Improvement& improvement) {
  Json json = {
      {"variant", improvement.variant}, {"baseline", improvement.baseline}, {"sequence", improvement.sequence}};
  for (std::size_t q = 0; q < quantity_keys.size(); ++q)
    json[quantity_keys[q]] = {{"before", six_json(improvement.before[q])},
                              {"after", six_json(improvement.after[q])},
                              {"percent", six_json(improvement.percent[q])}};
  return json;
}

Json comparison_json(const RunPlan& plan, const Comparison& c) {
  Json json = {{"before", c.before},
               {"after", c.after},
               {"quantity", to_string(c.quantity)},
               {"unit", unit_of(c.quantity)},
               {"sequences", c.sequences},
               {"left_out", c.left_out},
               {"better", c.better},
               {"worse", c.worse},
               {"gain", c.gain},
               {"gain_percent", c.gain_percent},
               {"pairs", c.test.pairs},
               {"enough", c.enough}};
  json["interval"] = c.enough ? Json({c.interval.low, c.interval.high}) : Json(nullptr);
  json["p"] = c.enough ? Json(c.test.p) : Json(nullptr);
  json["p_holm"] = c.enough ? Json(c.adjusted) : Json(nullptr);
  json["significant"] = c.is_significant();
  json["sentence"] = sentence(plan, c);
  return json;
}

Json robustness_json(const std::vector<RobustnessCurve>& curves) {
  Json json = {{"curves", Json::array()}, {"plots", Json::array()}};
  for (const RobustnessCurve& curve : curves) {
    Json points = Json::array();
    for (const RobustnessPoint& point : curve.points)
      points.push_back({{"strength", point.strength},
                        {"ate_rmse_m", point.error},
                        {"coverage", point.coverage},
                        {"runs", point.runs},
                        {"counted", point.counted}});
    json["curves"].push_back(
        {{"perturbation", curve.kind}, {"unit", curve.unit}, {"method", curve.method}, {"points", points}});
  }
  for (const RobustnessPlot& plot : robustness_plots(curves))
    json["plots"].push_back({{"name", plot.name}, {"svg", to_svg(plot.plot)}});
  return json;
}

Json published_json(const RunPlan& plan, const PublishedResults& published) {
  Json rows = Json::array();
  for (const PublishedResult& result : published.results) {
    Json values = Json::object();
    for (std::size_t s = 0; s < plan.matrix.sequences.size(); ++s)
      if (const auto value = result.values.find(published_name(plan.matrix.sequences[s])); value != result.values.end())
        values[plan.matrix.sequences[s].name] = value->second;
    if (!values.empty())
      rows.push_back({{"system", result.system},
                      {"alignment", result.alignment},
                      {"input", result.input},
                      {"citation", result.citation},
                      {"protocol", result.protocol},
                      {"ate_rmse_m", values}});
  }
  return rows;
}

}  // namespace

std::string results_json(const RunPlan& plan, const BenchResults& results, const Analysis& analysis,
                         const PublishedResults& published) {
  Json json = {{"format", "holdfast-bench 1"},      {"title", plan.matrix.title},
               {"about", plan.matrix.about},        {"matrix", plan.matrix.file.filename().string()},
               {"complete", results.is_complete()}, {"minimum_coverage", plan.matrix.minimum_coverage}};
  for (const Variant& variant : plan.variants) {
    Json values = Json::object();
    for (std::size_t a = 0; a < variant.choices.size(); ++a)
      values[plan.matrix.axes[a].name] = plan.matrix.axes[a].values[variant.choices[a]].name;
    for (const Axis& axis : plan.matrix.axes)
      if (variant.perturbation && axis.name == perturbation_axis)
        values[axis.name] = axis.values[*variant.perturbation].name;
    json["variants"].push_back({{"name", variant.name},
                                {"external", variant.is_external()},
                                {"values", values},
                                {"baseline", variant.baseline ? Json(*variant.baseline) : Json(nullptr)}});
  }
  for (const MatrixSequence& sequence : plan.matrix.sequences)
    json["sequences"].push_back({{"name", sequence.name}, {"about", sequence.about}});
  for (std::size_t i = 0; i < plan.runs.size(); ++i) json["runs"].push_back(run_json(plan, results, i));
  for (const char* list : {"cells", "improvements", "comparisons"}) json[list] = Json::array();
  for (const Cell& cell : analysis.cells) json["cells"].push_back(cell_json(cell));
  for (const Improvement& each : analysis.improvements) json["improvements"].push_back(improvement_json(each));
  for (const Comparison& each : analysis.comparisons) json["comparisons"].push_back(comparison_json(plan, each));
  json["published"] = published_json(plan, published);
  json["robustness"] = robustness_json(robustness_curves(plan, analysis));
  json["paper_tables"] = Json::array();
  for (const std::string& name : plan.matrix.analysis.tables)
    for (const PaperTable& table : paper_tables(name, plan, analysis, published))
      json["paper_tables"].push_back({{"name", table.name},
                                      {"caption", table.caption},
                                      {"latex", to_latex(table)},
                                      {"markdown", to_markdown(table)}});
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

namespace {

/// tables/NAME.tex, .md and .csv of every table that the matrix asks for.
void write_paper_tables(const std::filesystem::path& folder, const RunPlan& plan, const Analysis& analysis,
                        const PublishedResults& published) {
  for (const std::string& name : plan.matrix.analysis.tables) {
    std::string latex, markdown;
    for (const PaperTable& table : paper_tables(name, plan, analysis, published)) {
      latex += (latex.empty() ? "" : "\n") + to_latex(table);
      markdown += (markdown.empty() ? "" : "\n") + to_markdown(table);
    }
    write_file_atomically(folder / (name + ".tex"), latex);
    write_file_atomically(folder / (name + ".md"), markdown);
    write_file_atomically(folder / (name + ".csv"), to_csv(paper_figures(name, plan, analysis)));
  }
}

}  // namespace

void write_bench_reports(const std::filesystem::path& output, const RunPlan& plan, const BenchResults& results,
                         const PublishedResults& published) {
  const Analysis analysis = analyse(plan, results);
  const std::filesystem::path tables = output / "tables";
  std::filesystem::create_directories(tables);
  write_file_atomically(tables / "runs.csv", to_csv(runs_table(plan, results)));
  write_file_atomically(tables / "cells.csv", to_csv(cells_table(plan, analysis)));
  write_file_atomically(tables / "improvements.csv", to_csv(improvements_table(plan, analysis)));
  write_file_atomically(tables / "comparisons.csv", to_csv(comparisons_table(plan, analysis)));
  write_file_atomically(tables / "published.csv", to_csv(published_table(plan, published)));
  write_file_atomically(tables / "cost.csv", to_csv(cost_table(plan, analysis)));
  write_paper_tables(tables, plan, analysis, published);
  if (const auto curves = robustness_curves(plan, analysis); !curves.empty()) {
    write_file_atomically(tables / "robustness.csv", to_csv(robustness_table(curves)));
    std::filesystem::create_directories(output / "robustness");
    for (const RobustnessPlot& plot : robustness_plots(curves))
      write_file_atomically(output / "robustness" / (plot.name + ".svg"), to_svg(plot.plot));
  }
  write_file_atomically(output / "report.md", accuracy_report(plan, results, analysis, published));
  write_file_atomically(output / "cost.md", cost_report(plan, results, analysis, published));
  const std::string json = results_json(plan, results, analysis, published);
  write_file_atomically(output / "results.json", json);
  write_file_atomically(output / "report.html",
                        report_page(plan.matrix.title, json, thinned_tracks_json(output, plan, results)));
}

}  // namespace holdfast
