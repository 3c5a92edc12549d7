// SPDX-License-Identifier: BSD-3-Clause
#include "viewed_run.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/evaluation/alignment.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/map_io/cloud_ply.hpp"
#include "holdfast/map_io/map_file.hpp"
#include "holdfast/surface/decimation.hpp"
#include "holdfast/surface/mesh_files.hpp"
#include "holdfast/surface/mesh_patches.hpp"

namespace holdfast {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::json;
using Figures = std::vector<std::pair<std::string, std::string>>;

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

std::string millimetres(double metres) { return fixed_text(metres * 1e3, 2) + " mm"; }

/// The error of each pose of the path, from errors by time that are sorted; stamps may be rounded to a millisecond.
std::vector<float> errors_of(const Trajectory& path, const std::vector<std::pair<double, double>>& errors) {
  std::vector<float> result(path.size(), unknown);
  std::size_t next = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    while (next < errors.size() && errors[next].first < path[i].timestamp - 6e-4) ++next;
    if (next < errors.size() && std::abs(errors[next].first - path[i].timestamp) < 6e-4)
      result[i] = static_cast<float>(errors[next].second);
  }
  return result;
}

Json read_json(const fs::path& file) {
  const Json json = Json::parse(file_content(file, largest_file::json, "JSON that a run has written"), nullptr, false);
  if (json.is_discarded() || !json.is_object())
    throw InputError({file.string()}, "is no JSON that a run has written; run it again, or remove the file");
  return json;
}

/// Rows [t, x, y, z] or [t, value].
std::vector<std::vector<double>> rows_of(const Json& json, const char* name, std::size_t columns,
                                         const fs::path& file) {
  std::vector<std::vector<double>> rows;
  try {
    json.at(name).get_to(rows);
  } catch (const Json::exception&) {
    rows.assign(1, {});
  }
  for (const std::vector<double>& row : rows)
    if (row.size() != columns)
      throw InputError({file.string()}, std::string("'") + name + "' is no list of rows with " +
                                            std::to_string(columns) +
                                            " numbers; expected the file as a run has written it");
  return rows;
}

/// From the aligned estimate, and the same poses in the frame of the map, to the frame of the map.
std::optional<TrajectoryAlignment> to_map_frame(const std::vector<std::vector<double>>& aligned,
                                                const Trajectory& path) {
  std::vector<Eigen::Vector3d> from, to;
  std::size_t next = 0;
  for (const TimedPose& pose : path) {
    while (next < aligned.size() && aligned[next][0] < pose.timestamp - 6e-4) ++next;
    if (next == aligned.size()) break;
    if (std::abs(aligned[next][0] - pose.timestamp) > 6e-4) continue;
    from.emplace_back(aligned[next][1], aligned[next][2], aligned[next][3]);
    to.push_back(pose.T_world_camera.translation());
  }
  if (from.size() < 3) return std::nullopt;
  const auto matrix = [](const std::vector<Eigen::Vector3d>& places) {
    Eigen::Matrix3Xd columns(3, static_cast<Eigen::Index>(places.size()));
    for (std::size_t i = 0; i < places.size(); ++i) columns.col(static_cast<Eigen::Index>(i)) = places[i];
    return columns;
  };
  try {
    return align_positions(matrix(from), matrix(to), AlignmentKind::sim3);
  } catch (const Error&) {  // a camera that stood still
    return std::nullopt;
  }
}

void read_truth(const fs::path& file, ViewedRun& run) {
  const Json json = read_json(file);
  const auto truth = rows_of(json, "truth", 4, file), aligned = rows_of(json, "estimate", 4, file);
  std::vector<std::pair<double, double>> errors;
  for (const std::vector<double>& row : rows_of(json, "error", 2, file)) errors.emplace_back(row[0], row[1]);
  run.errors = errors_of(run.path, errors);
  const std::optional<TrajectoryAlignment> alignment = to_map_frame(aligned, run.path);
  if (!alignment) return;
  for (const std::vector<double>& row : truth)
    run.truth.emplace_back(row[0], alignment->apply({row[1], row[2], row[3]}));
}

/// The figures of run.json; those that another version does not write are left out.
Figures figures_of(const Json& json) {
  Figures figures;
  const auto number = [&](const char* pointer) {
    const Json::json_pointer place(pointer);
    return json.contains(place) && json.at(place).is_number() ? json.at(place).get<double>()
                                                              : std::numeric_limits<double>::quiet_NaN();
  };
  const auto add = [&](const std::string& name, double value, const auto& text) {
    if (!std::isnan(value)) figures.emplace_back(name, text(value));
  };
  const auto whole = [](double value) { return fixed_text(value, 0); };
  add("ATE RMSE", number("/evaluation/ate_m/rmse"), millimetres);
  add("coverage", number("/frames/coverage"), [](double share) { return fixed_text(share * 100.0, 1) + " %"; });
  add("tracking, median", number("/tracking/median_s"), [](double s) { return fixed_text(s * 1e3, 2) + " ms"; });
  add("frames", number("/frames/fed"), whole);
  add("lost", number("/frames/lost"), whole);
  const Json::json_pointer loops("/loops/closed");
  if (json.contains(loops)) add("loops", static_cast<double>(json.at(loops).size()), whole);
  const Json::json_pointer commit("/commit");
  if (json.contains(commit) && json.at(commit).is_string())
    figures.emplace_back("commit", json.at(commit).get<std::string>());
  return figures;
}

/// As many triangles as browsers are meant to draw.
std::vector<SurfacePatch> viewed_mesh(TriangleMesh mesh) {
  constexpr std::size_t most_triangles = 300'000;
  if (mesh.triangles.size() > most_triangles) decimate(mesh, most_triangles);
  return patches_of(mesh);
}

Trajectory keyframe_path(const MapSnapshot& map) {
  Trajectory path;
  for (const MapSnapshot::KeyFrame& keyframe : map.keyframes)
    path.push_back({keyframe.timestamp, keyframe.T_world_camera});
  return sort_and_clean(std::move(path));
}

void read_map_of(const fs::path& file, FoundResults& found) {
  const Map map = read_map(file);
  const std::vector<KeyFrameId> keyframes = map.keyframes_by_age();
  if (!keyframes.empty()) found.run.camera = *map.keyframe(keyframes.front()).frame.camera;
  found.map = make_snapshot(map);
  found.class_names = map.classes();
  map.points().for_each([&](MapPointId id, const MapPoint& point) {
    if (point.label != CellMask::unknown) found.classes.push_back({id, point.label});
  });
}

FoundResults find_in_folder(const fs::path& folder) {
  FoundResults found;
  found.run.title = fs::absolute(folder).lexically_normal().filename().string();
  if (found.run.title.empty())
    found.run.title = fs::absolute(folder).lexically_normal().parent_path().filename().string();
  const auto has = [&](const char* name) { return fs::exists(folder / name); };
  if (!has("trajectory.txt") && !has("map.hfm"))
    throw InputError({folder.string()},
                     "holds neither trajectory.txt nor map.hfm; expected a folder of `holdfast run`");
  if (has("map.hfm")) read_map_of(folder / "map.hfm", found);
  if (has("trajectory.txt")) found.run.path = read_trajectory(folder / "trajectory.txt");
  if (found.run.path.empty() && found.map) found.run.path = keyframe_path(*found.map);
  if (has("static_map.ply"))  // without a dense map it has the points of the map, which are there already
    found.run.cloud = read_cloud_ply(folder / "static_map.ply").value_or(std::vector<CloudPoint>());
  if (has("surface.ply")) found.run.mesh = viewed_mesh(read_mesh(folder / "surface.ply"));
  if (has("tracks.json")) read_truth(folder / "tracks.json", found.run);
  if (has("run.json")) found.run.figures = figures_of(read_json(folder / "run.json"));
  return found;
}

}  // namespace

ViewedRun viewed_run(const RunRecord& record) {
  ViewedRun run;
  run.title = record.source.name;
  run.camera = record.camera;
  run.path = record.trajectory;
  if (record.dense_map) run.cloud = *record.dense_map;
  if (record.surface) run.mesh = viewed_mesh(*record.surface);
  const auto add = [&](const char* name, const std::string& value) { run.figures.emplace_back(name, value); };
  if (const std::optional<Evaluation>& evaluation = record.evaluation) {
    std::vector<std::pair<double, double>> errors;
    for (const EvaluatedPose& pose : evaluation->poses) errors.emplace_back(pose.timestamp, pose.error);
    run.errors = errors_of(run.path, errors);
    const TrajectoryAlignment& alignment = evaluation->alignment;
    for (const TimedPose& pose : evaluation->truth_track)
      run.truth.emplace_back(pose.timestamp, alignment.rotation.transpose() *
                                                 (pose.T_world_camera.translation() - alignment.translation) /
                                                 alignment.scale);
    add("ATE RMSE", millimetres(evaluation->absolute_error.rmse));
  }
  add("coverage", fixed_text(record.coverage() * 100.0, 1) + " %");
  add("tracking, median", fixed_text(record.summary.tracking().median * 1e3, 2) + " ms");
  add("frames", std::to_string(record.summary.frames()));
  add("lost", std::to_string(record.summary.lost()));
  add("loops", std::to_string(record.loops.loops.size()));
  return run;
}

FoundResults find_results(const fs::path& path) {
  if (fs::is_directory(path)) return find_in_folder(path);
  FoundResults found;
  found.run.title = path.filename().string();
  read_map_of(path, found);
  found.run.path = keyframe_path(*found.map);
  return found;
}

}  // namespace holdfast
