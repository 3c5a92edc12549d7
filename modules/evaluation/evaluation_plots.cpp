// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "holdfast/core/check.hpp"
#include "holdfast/evaluation/camera_angles.hpp"
#include "holdfast/evaluation/evaluation.hpp"
#include "holdfast/evaluation/evaluation_plots.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "holdfast/evaluation/statistics.hpp"
#include "holdfast/evaluation/svg_plot.hpp"
#include "relative_error.hpp"
#include "vertical_axis.hpp"

namespace holdfast {

namespace {

constexpr double lift_pen = std::numeric_limits<double>::quiet_NaN();
constexpr const char* axis_names[3] = {"x", "y", "z"};

/// A distance between stamps beyond which a line is broken: the usual one with room for a single dropped frame.
double gap_threshold(const std::vector<double>& stamps) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < stamps.size(); ++i) intervals.push_back(stamps[i] - stamps[i - 1]);
  return intervals.empty() ? 0.0 : 2.5 * median(intervals);
}

/// How a path in space is drawn on paper.
struct Projection {
  int sight = 2;  ///< the axis that is looked along
  bool is_top_view = false;

  std::array<int, 2> axes() const { return {sight == 0 ? 1 : 0, sight == 2 ? 1 : 2}; }
};

Projection projection_of(const Evaluation& evaluation) {
  Eigen::Vector3d minimum = evaluation.poses.front().truth, maximum = minimum;
  for (const EvaluatedPose& pose : evaluation.poses) {
    minimum = minimum.cwiseMin(pose.truth);
    maximum = maximum.cwiseMax(pose.truth);
  }
  const Eigen::Vector3d extent = maximum - minimum;
  int narrowest = 2;
  // Strictly less, so that the projection axis is z in case of a tie: the actual top view if z points up.
  for (const int axis : {1, 0})
    if (extent[axis] < extent[narrowest]) narrowest = axis;
  const auto vertical = vertical_axis(evaluation.mean_up);
  if (!vertical) return {narrowest, narrowest == 2};
  // A path in a vertical plane would be a line from above.
  constexpr double nearly_flat = 0.2;
  if (narrowest != *vertical && extent[narrowest] < nearly_flat * extent[*vertical]) return {narrowest, false};
  return {*vertical, true};
}

/// Appends a point of the plot for each pose or its like; the line is lifted where poses are missing.
template <class Timed, class PointOf>
void append_with_gaps(PlotLine& line, const std::vector<Timed>& track, PointOf&& point_of) {
  std::vector<double> stamps;
  for (const Timed& point : track) stamps.push_back(point.timestamp);
  const double threshold = gap_threshold(stamps);
  for (std::size_t i = 0; i < track.size(); ++i) {
    if (i > 0 && stamps[i] - stamps[i - 1] > threshold) {
      line.x.push_back(lift_pen);
      line.y.push_back(lift_pen);
    }
    const auto [x, y] = point_of(track[i]);
    line.x.push_back(x);
    line.y.push_back(y);
  }
}

void append_track(PlotLine& line, const Trajectory& track, const std::array<int, 2>& axes) {
  append_with_gaps(line, track, [&](const TimedPose& pose) {
    const Eigen::Vector3d position = pose.T_world_camera.translation();
    return std::pair(position[axes[0]], position[axes[1]]);
  });
}

/// Metres, or millimetres when they read better.
struct LengthUnit {
  const char* name;
  double per_metre;
};
LengthUnit unit_for(double largest) { return largest < 0.2 ? LengthUnit{"mm", 1000.0} : LengthUnit{"m", 1.0}; }

std::string length_text(double metres) {
  const LengthUnit unit = unit_for(metres);
  return fixed_text(metres * unit.per_metre, unit.per_metre > 1.0 ? 1 : 3) + ' ' + unit.name;
}

/// Colours of small to large errors.
constexpr std::array<const char*, 5> error_colours{"#009e73", "#86b336", "#e6b800", "#e67e00", "#c8320a"};
/// The share of the poses whose errors the colours tell apart; the others have the last one.
constexpr double told_apart = 0.97;

/// The estimated path in lines of one colour each, by the error of its poses; what has no error is grey.
std::vector<PlotLine> path_by_error(const Evaluation& evaluation, const std::array<int, 2>& axes) {
  std::vector<double> errors;
  for (const EvaluatedPose& pose : evaluation.poses) errors.push_back(pose.error);
  const double largest = percentile(errors, 100.0 * told_apart);
  constexpr double width = 4.0;
  std::vector<PlotLine> lines;
  for (std::size_t i = 0; i < error_colours.size(); ++i) {
    const double bound = largest * static_cast<double>(i + 1) / error_colours.size();
    lines.push_back({i + 1 < error_colours.size() ? "error to " + length_text(bound) : "above",
                     error_colours[i],
                     {},
                     {},
                     width,
                     false,
                     1.0});
  }
  lines.push_back({"", plot_colour::grey, {}, {}, width, false, 1.0});
  const Trajectory& track = evaluation.estimate_track;
  const std::vector<double> stamps = stamps_of(track);
  const double threshold = gap_threshold(stamps);
  std::size_t next = 0;  // of the evaluated poses, which are some of those of the track
  std::size_t last_line = lines.size();
  for (std::size_t i = 1; i < track.size(); ++i) {
    while (next < evaluation.poses.size() && evaluation.poses[next].timestamp < stamps[i]) ++next;
    const bool has_error = next < evaluation.poses.size() && evaluation.poses[next].timestamp == stamps[i];
    std::size_t choice = error_colours.size();
    if (has_error)
      choice = largest > 0.0 ? std::min(error_colours.size() - 1,
                                        static_cast<std::size_t>(evaluation.poses[next].error / largest *
                                                                 static_cast<double>(error_colours.size())))
                             : 0;
    if (stamps[i] - stamps[i - 1] > threshold) {
      last_line = lines.size();
      continue;
    }
    PlotLine& line = lines[choice];
    const auto add = [&](const Eigen::Vector3d& place) {
      line.x.push_back(place[axes[0]]);
      line.y.push_back(place[axes[1]]);
    };
    if (choice != last_line) {
      line.x.push_back(lift_pen);
      line.y.push_back(lift_pen);
      add(track[i - 1].T_world_camera.translation());
    }
    add(track[i].T_world_camera.translation());
    last_line = choice;
  }
  std::erase_if(lines, [](const PlotLine& line) { return line.x.empty(); });
  return lines;
}

/// Shades the times without a pose, from `begin` on.
void shade_gaps(const Evaluation& evaluation, double begin, Plot& plot) {
  plot.band_label = evaluation.coverage ? "frames without a pose" : "no pair of poses";
  if (!evaluation.coverage) return;
  for (const CoverageGap& gap : evaluation.coverage->gaps) plot.bands.push_back({gap.begin - begin, gap.end - begin});
}

/// The time at which plots over time begin: a gap at the begin of the sequence belongs to the picture too.
double begin_of(const Evaluation& evaluation) {
  double begin = evaluation.poses.front().timestamp;
  if (evaluation.coverage && !evaluation.coverage->gaps.empty())
    begin = std::min(begin, evaluation.coverage->gaps.front().begin);
  return begin;
}

/// Plots one value of the estimate and of the truth over time: the truth thin over the broad estimate.
template <class Timed, class ValueOf>
std::string compared_over_time(const Evaluation& evaluation, const std::string& name, const std::string& unit,
                               const std::vector<Timed>& estimate, const std::vector<Timed>& truth,
                               const ValueOf& value_of) {
  const double begin = begin_of(evaluation);
  Plot plot;
  plot.title = name + " over time";
  plot.x_label = "time [s]";
  plot.y_label = name + " [" + unit + "]";
  plot.height = 230;
  shade_gaps(evaluation, begin, plot);
  const auto line_of = [&](const std::vector<Timed>& track, PlotLine line) {
    append_with_gaps(line, track,
                     [&](const Timed& timed) { return std::pair(timed.timestamp - begin, value_of(timed)); });
    return line;
  };
  plot.lines = {line_of(estimate, {"estimate", plot_colour::sky, {}, {}, 3.4, false, 1.0}),
                line_of(truth, {"truth", plot_colour::black, {}, {}, 1.1, false, 1.0})};
  return to_svg(plot);
}

}  // namespace

std::string top_view_svg(const Evaluation& evaluation) {
  const Projection projection = projection_of(evaluation);
  const std::array<int, 2> axes = projection.axes();
  Plot plot;
  plot.title =
      (projection.is_top_view ? std::string("Top view") : std::string("View along ") + axis_names[projection.sight]) +
      " (" + axis_names[axes[0]] + "-" + axis_names[axes[1]] + "), alignment " +
      std::string(to_string(evaluation.options.alignment)) + ", ATE RMSE " +
      length_text(evaluation.absolute_error.rmse);
  plot.x_label = std::string(axis_names[axes[0]]) + " [m]";
  plot.y_label = std::string(axis_names[axes[1]]) + " [m]";
  plot.equal_scale = true;
  plot.width = 760;
  plot.height = 620;

  // The truth is a thin line over the broad one of the estimate, so that neither hides the other.
  plot.lines = path_by_error(evaluation, axes);
  PlotLine truth{"truth", plot_colour::black, {}, {}, 1.1, false, 1.0};
  append_track(truth, evaluation.truth_track, axes);
  plot.lines.push_back(std::move(truth));
  const Eigen::Vector3d& begin = evaluation.poses.front().estimate;
  plot.points = {{"start", plot_colour::green, begin[axes[0]], begin[axes[1]]}};
  return to_svg(plot);
}

std::string error_over_time_svg(const Evaluation& evaluation) {
  const LengthUnit unit = unit_for(evaluation.absolute_error.maximum);
  std::vector<double> stamps;
  for (const EvaluatedPose& pose : evaluation.poses) stamps.push_back(pose.timestamp);
  const double threshold = gap_threshold(stamps), begin = begin_of(evaluation);

  Plot plot;
  plot.title = "Absolute error over time, alignment " + std::string(to_string(evaluation.options.alignment));
  plot.x_label = "time [s]";
  plot.y_label = std::string("position error [") + unit.name + "]";
  plot.y_from_zero = true;
  plot.height = 380;
  shade_gaps(evaluation, begin, plot);
  PlotLine error{"error", plot_colour::blue, {}, {}, 1.4, false, 1.0};
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (i > 0 && stamps[i] - stamps[i - 1] > threshold) {
      if (!evaluation.coverage) plot.bands.push_back({stamps[i - 1] - begin, stamps[i] - begin});
      error.x.push_back(lift_pen);
      error.y.push_back(lift_pen);
    }
    error.x.push_back(stamps[i] - begin);
    error.y.push_back(evaluation.poses[i].error * unit.per_metre);
  }
  plot.lines = {error};
  const double rmse = evaluation.absolute_error.rmse;
  plot.levels = {{"RMSE " + fixed_text(rmse * unit.per_metre, unit.per_metre > 1.0 ? 1 : 3) + ' ' + unit.name,
                  plot_colour::vermilion, rmse * unit.per_metre}};
  return to_svg(plot);
}

std::string position_over_time_svg(const Evaluation& evaluation, int axis) {
  HOLDFAST_CHECK(axis >= 0 && axis < 3, "axis " << axis);
  return compared_over_time(evaluation, axis_names[axis], "m", evaluation.estimate_track, evaluation.truth_track,
                            [axis](const TimedPose& pose) { return pose.T_world_camera.translation()[axis]; });
}

std::string angle_over_time_svg(const Evaluation& evaluation, int angle) {
  HOLDFAST_CHECK(angle >= 0 && angle < 3, "angle " << angle);
  constexpr double CameraAngles::*angles[3] = {&CameraAngles::roll, &CameraAngles::pitch, &CameraAngles::yaw};
  constexpr const char* names[3] = {"roll", "pitch", "yaw"};
  const EvaluatedAngles compared = camera_angles(evaluation);
  return compared_over_time(evaluation, names[angle], "deg", compared.estimate, compared.truth,
                            [member = angles[angle]](const CameraAngles& camera) { return camera.*member; });
}

}  // namespace holdfast
