// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "holdfast/bench/report_page.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/evaluation/statistics.hpp"

namespace holdfast {

namespace {

using Json = nlohmann::ordered_json;

/// A row of tracks.json: the stamp [s], then one or three values [m].
using TrackRow = std::vector<double>;
using TrackRows = std::vector<TrackRow>;

/// The tracks of one run.
struct Tracks {
  TrackRows truth, estimate, error;
};

/// Rows are used by their columns without further questions.
TrackRows rows_of_json(const Json& json, const char* key, std::size_t columns, const std::filesystem::path& file) {
  TrackRows rows = json.at(key);
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i].size() != columns)
      throw InputError({file.string()}, "is no file of tracks: row " + std::to_string(i) + " of '" + key + "' has " +
                                            std::to_string(rows[i].size()) + " numbers; expected " +
                                            std::to_string(columns) +
                                            "; remove the folder of the run and let --resume repeat it");
  return rows;
}

std::optional<Tracks> read_tracks(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::nullopt;
  const std::string text = file_content(file, largest_file::json, "a file of tracks");
  try {
    const Json json = Json::parse(text);
    return Tracks{rows_of_json(json, "truth", 4, file), rows_of_json(json, "estimate", 4, file),
                  rows_of_json(json, "error", 2, file)};
  } catch (const Json::exception& error) {
    throw InputError({file.string()}, std::string("is no file of tracks: ") + error.what() +
                                          "; remove the folder of the run and let --resume repeat it");
  }
}

/// A step in time that is none from frame to frame. Truth comes at least as often as frames do; the poses of a run that
/// lost most of them would not tell.
double gap_beside(const TrackRows& truth) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < truth.size(); ++i) steps.push_back(truth[i][0] - truth[i - 1][0]);
  return steps.empty() ? 0.25 : std::max(0.25, 3.0 * median(steps));
}

/// Lists of equal length with a name each; null in each of them breaks the line.
class Columns {
 public:
  Columns(std::vector<const char*> names, double origin) : names_(std::move(names)), origin_(origin) {
    for (const char* name : names_) json_[name] = Json::array();
  }
  void add(const TrackRow& row) {
    json_[names_[0]].push_back(rounded(row.at(0) - origin_, 1e3));
    for (std::size_t c = 1; c < names_.size(); ++c) json_[names_[c]].push_back(rounded(row.at(c), 1e4));
  }
  void add_break(double timestamp) {
    json_[names_[0]].push_back(rounded(timestamp - origin_, 1e3));
    for (std::size_t c = 1; c < names_.size(); ++c) json_[names_[c]].push_back(nullptr);
  }
  const Json& json() const { return json_; }

 private:
  static double rounded(double value, double scale) { return std::round(value * scale) / scale; }

  std::vector<const char*> names_;
  double origin_;
  Json json_ = Json::object();
};

/// Keeps one row of every stretch of equal length, of errors the largest, and the ends of every unbroken piece.
Json thinned(const TrackRows& rows, std::vector<const char*> names, double origin, double gap) {
  Columns columns(std::move(names), origin);
  const std::size_t stretch = (rows.size() + points_of_a_line - 1) / points_of_a_line;
  const bool is_error = !rows.empty() && rows.front().size() == 2;
  for (std::size_t begin = 0; begin < rows.size();) {
    std::size_t end = begin + 1;
    while (end < rows.size() && rows[end][0] - rows[end - 1][0] <= gap) ++end;
    if (begin > 0) columns.add_break(0.5 * (rows[begin - 1][0] + rows[begin][0]));
    for (std::size_t i = begin; i < end; i += stretch) {
      const auto first = rows.begin() + static_cast<std::ptrdiff_t>(i);
      const auto last = rows.begin() + static_cast<std::ptrdiff_t>(std::min(i + stretch, end));
      columns.add(is_error
                      ? *std::max_element(first, last, [](const TrackRow& a, const TrackRow& b) { return a[1] < b[1]; })
                      : *first);
    }
    if (!is_error && (end - 1 - begin) % stretch != 0) columns.add(rows[end - 1]);
    begin = end;
  }
  return columns.json();
}

}  // namespace

std::string thinned_tracks_json(const std::filesystem::path& output, const RunPlan& plan, const BenchResults& results) {
  std::vector<std::optional<Tracks>> tracks(plan.runs.size());
  std::vector<TrackRows> truths(plan.matrix.sequences.size());
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    if (!results.results[i] || !results.results[i]->has_errors) continue;
    tracks[i] = read_tracks(output / "runs" / plan.runs[i].id / "tracks.json");
    if (!tracks[i]) continue;
    // A run knows the truth of its own time only; the longest one serves all.
    TrackRows& truth = truths[plan.runs[i].sequence];
    if (tracks[i]->truth.size() > truth.size()) truth = tracks[i]->truth;
    tracks[i]->truth.clear();
  }
  Json json = {{"truth", Json::array()}, {"runs", Json::array()}};
  for (const TrackRows& truth : truths)
    json["truth"].push_back(truth.empty() ? Json(nullptr)
                                          : thinned(truth, {"t", "x", "y", "z"}, truth.front()[0], gap_beside(truth)));
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    const TrackRows& truth = truths[plan.runs[i].sequence];
    if (!tracks[i] || truth.empty()) {
      json["runs"].push_back(nullptr);
      continue;
    }
    const double begin = truth.front()[0], gap = gap_beside(truth);
    json["runs"].push_back({{"track", thinned(tracks[i]->estimate, {"t", "x", "y", "z"}, begin, gap)},
                            {"error", thinned(tracks[i]->error, {"t", "e"}, begin, gap)}});
  }
  return json.dump() + "\n";
}

}  // namespace holdfast
