// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "holdfast/evaluation/evaluation.hpp"
#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

namespace {

std::string padded(const std::string& text, std::size_t width) {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}
std::string filled(const std::string& text, std::size_t width) {
  return text.size() < width ? text + std::string(width - text.size(), ' ') : text;
}

std::string describe(AlignmentKind kind, double scale) {
  switch (kind) {
    case AlignmentKind::se3:
      return "se3 (rotation and translation by least squares)";
    case AlignmentKind::sim3:
      return "sim3 (rotation, translation and scale by least squares; scale " + fixed_text(scale, 6) +
             ", also applied before RPE)";
    case AlignmentKind::none:
      return "none (compared as they are)";
  }
  return {};
}

std::string table_row(const std::string& name, const char* unit, const Statistics& statistics) {
  std::string line = filled(name, 34) + filled(unit, 6) + padded(std::to_string(statistics.count), 7);
  for (const double value : {statistics.rmse, statistics.standard_deviation, statistics.maximum, statistics.minimum,
                             statistics.mean, statistics.median})
    line += padded(statistics.count ? fixed_text(value, 6) : "-", 11);
  return line + '\n';
}

using Json = nlohmann::ordered_json;

Json to_json_value(const Statistics& statistics) {
  // The library writes what is not a number as null, which is what a statistic of nothing is.
  return {{"rmse", statistics.rmse},   {"standard_deviation", statistics.standard_deviation},
          {"max", statistics.maximum}, {"min", statistics.minimum},
          {"mean", statistics.mean},   {"median", statistics.median}};
}

/// Rows "quantity,statistic,value,unit".
class CsvRows {
 public:
  void add(const std::string& quantity, const char* statistic, const std::string& value, const char* unit) {
    text_ += quantity + ',' + statistic + ',' + value + ',' + unit + '\n';
  }
  void add(const std::string& quantity, const char* statistic, std::size_t value) {
    add(quantity, statistic, std::to_string(value), "");
  }
  void add(const std::string& quantity, const Statistics& statistics, const char* unit) {
    const auto row = [&](const char* name, double value) {
      add(quantity, name, std::isnan(value) ? "" : shortest_text(value), unit);
    };
    row("rmse", statistics.rmse);
    row("standard_deviation", statistics.standard_deviation);
    row("max", statistics.maximum);
    row("min", statistics.minimum);
    row("mean", statistics.mean);
    row("median", statistics.median);
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_ = "quantity,statistic,value,unit\n";
};

}  // namespace

std::string to_text(const Evaluation& evaluation) {
  const EvaluationOptions& options = evaluation.options;
  std::string text;
  text += "truth      " + options.truth_name + ": " + counted(evaluation.truth_poses, "pose") +
          (options.truth_frame == "raw" ? "" : ", " + options.truth_frame) + '\n';
  text += "estimate   " + options.estimate_name + ": " + counted(evaluation.estimate_poses, "pose") + '\n';
  text += "pairing    one-to-one, nearest stamps first, closer than " + shortest_text(options.max_time_difference) +
          " s: " + counted(evaluation.poses.size(), "pair") + " over " + fixed_text(evaluation.duration, 2) +
          " s and " + fixed_text(evaluation.path_length, 3) + " m of true path\n";
  if (options.time_offset != 0.0)
    text += "clocks     " + fixed_text(options.time_offset, 4) + " s added to the stamps of the estimate\n";
  text += "alignment  " + describe(options.alignment, evaluation.alignment.scale) + '\n';
  text += "coverage   ";
  if (evaluation.coverage) {
    const Coverage& coverage = *evaluation.coverage;
    text += fixed_text(100.0 * coverage.ratio(), 2) + " %: " + std::to_string(coverage.poses) + " of " +
            counted(coverage.frames, "frame") + " have a pose";
    if (!coverage.gaps.empty())
      text +=
          "; " + counted(coverage.gaps.size(), "gap") + ", the longest of " + counted(coverage.longest_gap(), "frame");
    if (coverage.poses_of_no_frame > 0)
      text += "; not counted: " + counted(coverage.poses_of_no_frame, "pose") + " with the stamp of no frame";
    text += '\n';
  } else {
    text += "unknown (no list of frames given)\n";
  }
  text += '\n' + filled("", 40) + "  pairs       RMSE       S.D.        max        min       mean     median\n";
  text += table_row("ATE", "[m]", evaluation.absolute_error);
  const std::string time_step = "RPE per " + shortest_text(options.time_step) + " s";
  text += table_row(time_step + ", translation", "[m]", evaluation.error_per_time.translation);
  text += table_row(time_step + ", rotation", "[deg]", evaluation.error_per_time.rotation);
  const std::string path_step = "RPE per " + shortest_text(options.path_step) + " m";
  text += table_row(path_step + ", translation", "[m]", evaluation.error_per_way.translation);
  text += table_row(path_step + ", rotation", "[deg]", evaluation.error_per_way.rotation);
  if (const SegmentError& error = evaluation.segment_error; error.segments > 0) {
    text += '\n' + filled("KITTI, segments of", 34) + "  segments  translation [%]  rotation [deg/m]\n";
    const auto row = [&](const std::string& name, std::size_t segments, double translation, double rotation) {
      text += filled("  " + name, 34) + padded(std::to_string(segments), 10) + padded(fixed_text(translation, 4), 17) +
              padded(fixed_text(rotation, 6), 18) + '\n';
    };
    for (const SegmentError::OfLength& of_length : error.lengths)
      row(shortest_text(of_length.length) + " m", of_length.segments, of_length.translation, of_length.rotation);
    row("all", error.segments, error.translation, error.rotation);
  }
  if (const auto& drift = evaluation.scale_drift) {
    text += "\nscale      by windows of a tenth of the true path, relative to the whole:";
    for (const ScaleDrift::Window& window : drift->windows) text += ' ' + fixed_text(window.scale, 4);
    text += "\n           drift from the first window to the last " + fixed_text(100.0 * drift->drift, 2) +
            " %, largest to smallest " + fixed_text(100.0 * drift->spread, 2) + " %\n";
  }
  if (evaluation.error_per_time.pairs == 0)
    text += "No pair of poses is " + shortest_text(options.time_step) + " s apart and near a true pose.\n";
  if (evaluation.error_per_way.pairs == 0)
    text += "No pair of poses is " + shortest_text(options.path_step) + " m of true path apart.\n";
  if (evaluation.error_per_time.uneven_pairs > 0)
    text += "Gaps: " + counted(evaluation.error_per_time.uneven_pairs, "pair") + " of RPE per " +
            shortest_text(options.time_step) + " s off that time by more than 10 % (counted, as the benchmark does).\n";
  if (evaluation.error_per_way.omitted_pairs > 0)
    text += "Gaps: " + counted(evaluation.error_per_way.omitted_pairs, "pair") + " left out of RPE per " +
            shortest_text(options.path_step) + " m, more than 10 % longer than that.\n";
  return text;
}

std::string to_json(const Evaluation& evaluation) {
  const EvaluationOptions& options = evaluation.options;
  const TrajectoryAlignment& alignment = evaluation.alignment;
  Json rotation = Json::array();
  for (int row = 0; row < 3; ++row)
    rotation.push_back({alignment.rotation(row, 0), alignment.rotation(row, 1), alignment.rotation(row, 2)});
  const Eigen::Vector3d& translation = alignment.translation;

  Json json;
  json["truth"] = {{"name", options.truth_name}, {"poses", evaluation.truth_poses}, {"frame", options.truth_frame}};
  json["estimate"] = {{"name", options.estimate_name}, {"poses", evaluation.estimate_poses}};
  json["pairing"] = {{"method", "one-to-one, nearest stamps first"},
                     {"max_time_difference_s", options.max_time_difference},
                     {"time_offset_s", options.time_offset},
                     {"pairs", evaluation.poses.size()},
                     {"duration_s", evaluation.duration},
                     {"true_path_m", evaluation.path_length}};
  json["alignment"] = {{"kind", to_string(options.alignment)},
                       {"scale", alignment.scale},
                       {"rotation", rotation},
                       {"translation_m", {translation.x(), translation.y(), translation.z()}}};
  json["ate_m"] = to_json_value(evaluation.absolute_error);
  json["rpe_per_time"] = {{"step_s", options.time_step},
                          {"pairs", evaluation.error_per_time.pairs},
                          {"uneven_pairs", evaluation.error_per_time.uneven_pairs},
                          {"translation_m", to_json_value(evaluation.error_per_time.translation)},
                          {"rotation_deg", to_json_value(evaluation.error_per_time.rotation)}};
  json["rpe_per_way"] = {{"step_m", options.path_step},
                         {"pairs", evaluation.error_per_way.pairs},
                         {"omitted_pairs", evaluation.error_per_way.omitted_pairs},
                         {"translation_m", to_json_value(evaluation.error_per_way.translation)},
                         {"rotation_deg", to_json_value(evaluation.error_per_way.rotation)}};
  json["kitti_segments"] = nullptr;
  if (const SegmentError& error = evaluation.segment_error; error.segments > 0) {
    Json lengths = Json::array();
    for (const SegmentError::OfLength& of_length : error.lengths)
      lengths.push_back({{"length_m", of_length.length},
                         {"segments", of_length.segments},
                         {"translation_percent", of_length.translation},
                         {"rotation_deg_per_m", of_length.rotation}});
    json["kitti_segments"] = {{"segments", error.segments},
                              {"translation_percent", error.translation},
                              {"rotation_deg_per_m", error.rotation},
                              {"lengths", lengths}};
  }
  json["scale_drift"] = nullptr;
  if (const auto& drift = evaluation.scale_drift) {
    Json windows = Json::array();
    for (const ScaleDrift::Window& window : drift->windows)
      windows.push_back({{"begin_s", window.begin},
                         {"end_s", window.end},
                         {"pairs", window.pairs},
                         {"relative_scale", window.scale}});
    json["scale_drift"] = {
        {"drift_percent", 100.0 * drift->drift}, {"spread_percent", 100.0 * drift->spread}, {"windows", windows}};
  }
  json["coverage"] = nullptr;
  if (const auto& coverage = evaluation.coverage)
    json["coverage"] = {{"ratio", coverage->ratio()},    {"frames", coverage->frames},
                        {"poses", coverage->poses},      {"poses_of_no_frame", coverage->poses_of_no_frame},
                        {"gaps", coverage->gaps.size()}, {"longest_gap_frames", coverage->longest_gap()}};
  Json& warnings = json["warnings"] = Json::array();
  for (const Diagnostic& warning : evaluation.warnings) warnings.push_back(warning.to_string());
  // A file name need not be UTF-8; its odd bytes must not cost the figures.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::string to_tracks_json(const Evaluation& evaluation) {
  const auto numbers = [](std::initializer_list<double> values, int decimals) {
    std::string text;
    for (const double value : values) {
      text += ',';
      text += fixed_text(value, decimals);
    }
    return text;
  };
  const auto track = [&](const Trajectory& poses) {
    std::string text;
    for (const TimedPose& pose : poses) {
      const Eigen::Vector3d position = pose.T_world_camera.translation();
      text += (text.empty() ? "[" : ",[") + fixed_text(pose.timestamp, 3) +
              numbers({position.x(), position.y(), position.z()}, 4) + "]";
    }
    return text;
  };
  const auto rotations = [&](const Trajectory& poses) {
    std::string text;
    for (const TimedPose& pose : poses) {
      Eigen::Quaterniond q(pose.T_world_camera.linear());
      if (q.w() < 0.0) q.coeffs() *= -1.0;
      text += (text.empty() ? "[" : ",[") + fixed_text(q.x(), 5) + numbers({q.y(), q.z(), q.w()}, 5) + "]";
    }
    return text;
  };
  std::string errors;
  for (const EvaluatedPose& pose : evaluation.poses)
    errors += (errors.empty() ? "[" : ",[") + fixed_text(pose.timestamp, 3) + numbers({pose.error}, 6) + "]";
  return "{\"truth\":[" + track(evaluation.truth_track) + "],\n\"estimate\":[" + track(evaluation.estimate_track) +
         "],\n\"error\":[" + errors + "],\n\"truth_rotation\":[" + rotations(evaluation.truth_track) +
         "],\n\"estimate_rotation\":[" + rotations(evaluation.estimate_track) + "]}\n";
}

std::string to_csv(const Evaluation& evaluation) {
  const EvaluationOptions& options = evaluation.options;
  CsvRows rows;
  rows.add("alignment", "kind", std::string(to_string(options.alignment)), "");
  rows.add("alignment", "scale", shortest_text(evaluation.alignment.scale), "");
  rows.add("truth", "poses", evaluation.truth_poses);
  rows.add("truth", "frame", options.truth_frame, "");
  rows.add("estimate", "poses", evaluation.estimate_poses);
  rows.add("pairing", "max_time_difference", shortest_text(options.max_time_difference), "s");
  rows.add("pairing", "time_offset", shortest_text(options.time_offset), "s");
  rows.add("pairing", "pairs", evaluation.poses.size());
  rows.add("pairing", "duration", shortest_text(evaluation.duration), "s");
  rows.add("pairing", "true_path", shortest_text(evaluation.path_length), "m");
  rows.add("ate", evaluation.absolute_error, "m");
  rows.add("rpe_per_time", "step", shortest_text(options.time_step), "s");
  rows.add("rpe_per_time", "pairs", evaluation.error_per_time.pairs);
  rows.add("rpe_per_time", "uneven_pairs", evaluation.error_per_time.uneven_pairs);
  rows.add("rpe_per_time_translation", evaluation.error_per_time.translation, "m");
  rows.add("rpe_per_time_rotation", evaluation.error_per_time.rotation, "deg");
  rows.add("rpe_per_way", "step", shortest_text(options.path_step), "m");
  rows.add("rpe_per_way", "pairs", evaluation.error_per_way.pairs);
  rows.add("rpe_per_way", "omitted_pairs", evaluation.error_per_way.omitted_pairs);
  rows.add("rpe_per_way_translation", evaluation.error_per_way.translation, "m");
  rows.add("rpe_per_way_rotation", evaluation.error_per_way.rotation, "deg");
  if (const SegmentError& error = evaluation.segment_error; error.segments > 0) {
    rows.add("kitti_segments", "segments", error.segments);
    rows.add("kitti_segments", "translation", shortest_text(error.translation), "%");
    rows.add("kitti_segments", "rotation", shortest_text(error.rotation), "deg/m");
  }
  if (const auto& drift = evaluation.scale_drift) {
    rows.add("scale_drift", "first_to_last", shortest_text(100.0 * drift->drift), "%");
    rows.add("scale_drift", "spread", shortest_text(100.0 * drift->spread), "%");
  }
  if (const auto& coverage = evaluation.coverage) {
    rows.add("coverage", "ratio", shortest_text(coverage->ratio()), "");
    rows.add("coverage", "frames", coverage->frames);
    rows.add("coverage", "poses", coverage->poses);
    rows.add("coverage", "poses_of_no_frame", coverage->poses_of_no_frame);
    rows.add("coverage", "gaps", coverage->gaps.size());
    rows.add("coverage", "longest_gap_frames", coverage->longest_gap());
  } else {
    rows.add("coverage", "ratio", "unknown", "");
  }
  rows.add("warnings", "count", evaluation.warnings.size());
  return rows.text();
}

}  // namespace holdfast
