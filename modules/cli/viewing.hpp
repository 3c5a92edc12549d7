// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/run/run_record.hpp"

namespace holdfast {

class Viewer;
struct ViewedRun;

/// What the commands do with the viewer. In a build without it there are no viewers, and the rest throws PluginError
/// that says how to build it.

/// Adds the observer `viewer` to a configuration that does not choose it.
void add_viewer(Configuration& configuration, const Registry& registry);
/// The viewers that serve now.
std::vector<std::shared_ptr<Viewer>> running_viewers_of_program();
/// Shows a run that has ended in them, until a signal asks for the end.
void show_until_stopped(const std::vector<std::shared_ptr<Viewer>>& viewers, const RunRecord& record);
/// Shows the results in a folder, or a map, until a signal asks for the end. Throws InputError for what is neither.
void show_results_until_stopped(const std::filesystem::path& results, const std::string& listen, int port);

}  // namespace holdfast
