// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/run/results.hpp"

#include "holdfast/core/error.hpp"
#include "holdfast/evaluation/report.hpp"
#include "holdfast/map_io/map_export.hpp"
#include "holdfast/map_io/map_file.hpp"

namespace holdfast {

namespace {

void write_evaluation(const Evaluation& evaluation, const std::filesystem::path& folder) {
  write_file_atomically(folder / "evaluation.json", to_json(evaluation));
  write_file_atomically(folder / "tracks.json", to_tracks_json(evaluation));
  write_file_atomically(folder / "trajectory.svg", top_view_svg(evaluation));
  write_file_atomically(folder / "error.svg", error_over_time_svg(evaluation));
}

void write_maps(const RunRecord& record, const std::filesystem::path& folder) {
  write_map(folder / "map.hfm", record.map);
  if (record.dense_map)
    write_cloud_ply(folder / "static_map.ply", *record.dense_map);
  else
    write_points_ply(folder / "static_map.ply", record.map);
}

}  // namespace

const std::vector<std::string>& result_names() {
  static const std::vector<std::string> names = {"report.html",     "run.json",    "trajectory.txt", "keyframes.txt",
                                                 "evaluation.json", "tracks.json", "trajectory.svg", "error.svg",
                                                 "config.yaml",     "map.hfm",     "static_map.ply", "objects.csv",
                                                 "overlay"};
  return names;
}

void write_results(const RunRecord& record, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError({folder.string()}, "the folder for the results cannot be made: " + error.message());
  write_trajectory(folder / "trajectory.txt", record.trajectory);
  write_trajectory(folder / "keyframes.txt", record.keyframes);
  write_file_atomically(folder / "config.yaml", to_yaml(record.configuration));
  if (record.evaluation) write_evaluation(*record.evaluation, folder);
  write_file_atomically(folder / "run.json", run_json(record));
  write_file_atomically(folder / "report.html", report_html(record));
  if (!record.localised_only && !record.map.keyframes().empty()) write_maps(record, folder);
}

}  // namespace holdfast
