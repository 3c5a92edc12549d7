// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/map_snapshot.hpp"
#include "holdfast/run/run_record.hpp"
#include "holdfast/viewer/viewer.hpp"

namespace holdfast {

/// A run that has just ended, for the viewer.
ViewedRun viewed_run(const RunRecord& record);

/// What a folder or a map file has for the viewer.
struct FoundResults {
  ViewedRun run;
  std::optional<MapSnapshot> map;
  std::vector<std::string> class_names;  ///< empty = the map has no classes
  std::vector<ViewedClass> classes;      ///< of points whose class is known
};

/// Reads the results of a run from its folder, as far as they are there, or a map file. The truth comes from
/// tracks.json and is moved into the frame of the map by aligning the positions of the estimate. Throws InputError for
/// what holds neither a trajectory nor a map, and for a file that cannot be read.
FoundResults find_results(const std::filesystem::path& path);

}  // namespace holdfast
