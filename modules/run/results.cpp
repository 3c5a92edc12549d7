// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/run/results.hpp"

#include <exception>
#include <string>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/evaluation/report.hpp"
#include "holdfast/map_io/map_export.hpp"
#include "holdfast/map_io/map_file.hpp"
#include "holdfast/plugin/parameter_table.hpp"
#include "holdfast/surface/mesh_files.hpp"
#include "holdfast/surface/surface_settings.hpp"

namespace holdfast {

namespace {

/// Writes results one after the other; one that cannot be written does not take the following ones with it.
class ResultWriter {
 public:
  explicit ResultWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// `write` gets the path of the file.
  template <class Write>
  void write(const char* name, const Write& write) {
    const std::filesystem::path file = folder_ / name;
    try {
      write(file);
    } catch (const InputError& error) {
      add_failure(error.what());  // names the file
    } catch (const std::exception& error) {
      add_failure(file.string() + ": " + error.what());
    }
  }
  /// `content` is a function, since making the content may fail as well.
  template <class Content>
  void write_text(const char* name, const Content& content) {
    write(name, [&](const std::filesystem::path& file) { write_file_atomically(file, content()); });
  }
  void throw_failures() const {
    if (failures_.empty()) return;
    throw InputError({folder_.string()}, std::to_string(count_) + (count_ == 1 ? " result could" : " results could") +
                                             " not be written, the others are whole:" + failures_);
  }

 private:
  void add_failure(const std::string& message) {
    failures_ += "\n  " + message;
    ++count_;
  }

  std::filesystem::path folder_;
  std::string failures_;
  int count_ = 0;
};

void write_dense_map(const RunRecord& record, const std::filesystem::path& file) {
  if (record.dense_map)
    write_cloud_ply(file, *record.dense_map);
  else
    write_points_ply(file, record.map);
}

}  // namespace

const std::vector<std::string>& result_names() {
  static const std::vector<std::string> names = {
      "report.html",    "run.json",    "trajectory.txt", "keyframes.txt", "evaluation.json", "tracks.json",
      "trajectory.svg", "error.svg",   "config.yaml",    "map.hfm",       "static_map.ply",  "surface.ply",
      "surface.obj",    "surface.glb", "map.pgm",        "map.yaml",      "octomap.bt",      "octomap.ot",
      "objects.csv",    "health.csv",  "overlay",        "run.mcap",      "surface_views"};
  return names;
}

void write_results(const RunRecord& record, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError({folder.string()}, "the folder for the results cannot be made: " + error.message());
  using std::filesystem::path;
  const bool has_map = !record.localised_only && !record.map.keyframes().empty();
  // In the order of their worth, for a disk that fills up: first what only another run could give again.
  ResultWriter results(folder);
  results.write("trajectory.txt", [&](const path& file) { write_trajectory(file, record.trajectory); });
  if (has_map) results.write("map.hfm", [&](const path& file) { write_map(file, record.map); });
  results.write_text("run.json", [&] { return run_json(record); });
  results.write_text("config.yaml", [&] { return to_yaml(record.configuration); });
  results.write("keyframes.txt", [&](const path& file) { write_trajectory(file, record.keyframes); });
  if (record.evaluation) {
    results.write_text("evaluation.json", [&] { return to_json(*record.evaluation); });
    results.write_text("tracks.json", [&] { return to_tracks_json(*record.evaluation); });
  }
  results.write_text("report.html", [&] { return report_html(record, overlay_pictures(folder)); });
  if (record.evaluation) {
    results.write_text("trajectory.svg", [&] { return top_view_svg(*record.evaluation); });
    results.write_text("error.svg", [&] { return error_over_time_svg(*record.evaluation); });
  }
  if (has_map) results.write("static_map.ply", [&](const path& file) { write_dense_map(record, file); });
  if (has_map && record.surface_views)
    results.write("surface_views", [&](const path& views) { write_views(views, *record.surface_views, record.map); });
  if (record.surface && !record.surface->empty()) {
    const auto settings = section_settings<SurfaceSettings>(record.configuration, "surface");
    for (const std::string& format : settings.formats)
      results.write(("surface." + format).c_str(), [&](const path& file) { write_mesh(file, *record.surface); });
  }
  if (record.navigation) {
    results.write_text("octomap.bt", [&] { return record.navigation->octomap; });
    results.write_text("octomap.ot", [&] { return record.navigation->octomap_probabilities; });
    if (record.navigation->floor) {
      results.write_text("map.pgm", [&] { return grid_map_pgm(record.navigation->grid); });
      results.write_text("map.yaml", [&] { return grid_map_yaml(record.navigation->grid, "map.pgm"); });
    }
  }
  results.throw_failures();
}

}  // namespace holdfast
