// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/run/run_record.hpp"

namespace holdfast {

/// Names of all files and folders that a run may write into its folder, in the order in which an earlier run's are
/// removed. The observers `objects` and `overlay` write two of them.
const std::vector<std::string>& result_names();

/// Writes the results of a run into an existing or new folder: trajectory.txt, keyframes.txt, run.json, report.html and
/// config.yaml; where there is a true trajectory, evaluation.json, tracks.json, trajectory.svg and error.svg; where the
/// run has made or changed a map, map.hfm and static_map.ply (the dense map where there is one, else the map points).
/// Each file is replaced atomically, the most important ones first: trajectory, map, run.json, then the others. If some
/// cannot be written, the others are, and then InputError names the missing ones.
void write_results(const RunRecord& record, const std::filesystem::path& folder);

/// Whether the run found poses for a smaller share of its frames than run.minimum_coverage.
bool has_low_coverage(const RunRecord& record);
/// Most frequent tracking failure of a run with low coverage, and what to check, in whole sentences. Empty for other
/// runs, and for interrupted or failed ones.
std::string coverage_warning(const RunRecord& record);

/// Describes why the poses of a run are unusable, and what to check, in whole sentences: every pose initialised a map
/// (TrackingStatus::initialised), several times, and none was tracked. Empty for other runs.
std::string unsupported_poses(const RunRecord& record);

/// The commit that this library was built from, with "-dirty" for changes that were not committed; "unknown" outside a
/// checkout.
const char* build_commit();

/// The content of run.json: version, seed, machine, counts, coverage, stage times and errors.
std::string run_json(const RunRecord& record);
/// The content of report.html: one self-contained page.
std::string report_html(const RunRecord& record);
/// The same with the pictures of the observer `overlay`, which the page plays: their addresses relative to the page, as
/// overlay_pictures() gives them. The page refers to them and does not contain them.
std::string report_html(const RunRecord& record, const std::vector<std::string>& pictures);
/// The pictures (jpg or png) that the observer `overlay` has written into the folder of a run, by frame: paths relative
/// to the folder. Empty where there are none, or a video.
std::vector<std::string> overlay_pictures(const std::filesystem::path& folder);
/// A short summary for a terminal: stage times and one line per figure.
std::string summary_text(const RunRecord& record);

}  // namespace holdfast
