// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation_table.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

namespace {

std::string right_aligned(const std::string& text, std::size_t width) {
  return std::string(text.size() < width ? width - text.size() : 1, ' ') + text;
}

std::string figures_row(const Evaluation& evaluation) {
  const auto number = [](double value, std::size_t pairs, int decimals) {
    return right_aligned(pairs > 0 ? fixed_text(value, decimals) : "-", 11);
  };
  const RelativeError& relative = evaluation.error_per_time;
  const Statistics& error = evaluation.absolute_error;
  std::string row = right_aligned(std::to_string(evaluation.estimate_poses), 8);
  row += right_aligned(std::to_string(evaluation.poses.size()), 8);
  row += right_aligned(evaluation.coverage ? fixed_text(100.0 * evaluation.coverage->ratio(), 2) : "-", 12);
  for (const double value : {error.rmse, error.median, error.maximum}) row += number(value, error.count, 6);
  row += number(relative.translation.rmse, relative.pairs, 6) + number(relative.rotation.rmse, relative.pairs, 4);
  return row;
}

/// A field of a CSV file, with quotation marks where it needs them.
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace

std::string comparison_text(const std::vector<ComparedEstimate>& estimates) {
  std::size_t width = 8;
  for (const ComparedEstimate& estimate : estimates) width = std::max(width, estimate.name.size());
  std::string text, rows;
  for (const ComparedEstimate& estimate : estimates) {
    rows += estimate.name + std::string(width - estimate.name.size(), ' ');
    if (!estimate.evaluation) {
      rows += "  cannot be compared\n";
      continue;
    }
    const EvaluationOptions& options = estimate.evaluation->options;
    rows += figures_row(*estimate.evaluation) + '\n';
    if (!text.empty()) continue;
    text = "truth      " + options.truth_name + ": " + counted(estimate.evaluation->truth_poses, "pose") +
           (options.truth_frame == "raw" ? "" : ", " + options.truth_frame) + '\n';
    text += "pairing    one-to-one, nearest stamps first, closer than " + shortest_text(options.max_time_difference) +
            " s\nalignment  " + std::string(to_string(options.alignment)) + ", of each estimate by itself\n";
    text += "RMSE, median and largest value of ATE; RMSE of RPE per " + shortest_text(options.time_step) + " s\n\n";
    text += std::string(width, ' ') +
            "   poses   pairs  coverage %    ATE [m]     median        max    RPE [m]  RPE [deg]\n";
  }
  return text + rows;
}

std::string comparison_json(const std::vector<ComparedEstimate>& estimates) {
  using Json = nlohmann::ordered_json;
  Json json = Json::array();
  for (const ComparedEstimate& estimate : estimates)
    json.push_back(estimate.evaluation ? Json::parse(to_json(*estimate.evaluation))
                                       : Json{{"estimate", {{"name", estimate.name}}}, {"error", estimate.failure}});
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::string comparison_csv(const std::vector<ComparedEstimate>& estimates) {
  std::string text;
  for (const ComparedEstimate& estimate : estimates) {
    if (!estimate.evaluation) continue;
    std::istringstream rows(to_csv(*estimate.evaluation));
    std::string row;
    std::getline(rows, row);
    if (text.empty()) text = "estimate," + row + '\n';
    while (std::getline(rows, row)) text += csv_field(estimate.name) + ',' + row + '\n';
  }
  return text;
}

}  // namespace holdfast
