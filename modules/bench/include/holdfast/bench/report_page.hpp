// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "holdfast/bench/run_plan.hpp"
#include "holdfast/bench/run_scheduler.hpp"

namespace holdfast {

/// Maximum number of points of a line on the page.
inline constexpr std::size_t points_of_a_line = 1500;

/// The tracks of all runs, thinned for drawing, as JSON: "truth", a line for every sequence, and "runs", for every run
/// that left a trajectory { "track": line, "error": curve }; null where there is nothing. A line is { "t", "x", "y",
/// "z" } and a curve { "t", "e" }, lists of equal length; t [s] from the first truth of the sequence, the others [m].
/// Where frames are missing an element of null breaks the line. Lines are thinned evenly in time; curves keep the
/// maximum of each interval.
std::string thinned_tracks_json(const std::filesystem::path& output, const RunPlan& plan, const BenchResults& results);

/// A self-contained HTML page with the data of results_json() and thinned_tracks_json(): sortable tables and
/// trajectories. Links to the runs' folders are relative to the page, which belongs into the output folder of the
/// bench. `title` is that of the page.
std::string report_page(const std::string& title, const std::string& results, const std::string& tracks);

}  // namespace holdfast
