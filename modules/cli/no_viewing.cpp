// SPDX-License-Identifier: BSD-3-Clause
// The viewer of a build without it.
#include "holdfast/core/error.hpp"
#include "viewing.hpp"

namespace holdfast {

namespace {

constexpr const char* reason =
    "this build has no viewer; install Boost's headers (Debian: libboost-dev), configure Holdfast and "
    "build again";

}  // namespace

void add_viewer(Configuration&, const Registry&) { throw PluginError(reason); }
std::vector<std::shared_ptr<Viewer>> running_viewers_of_program() { return {}; }
void show_until_stopped(const std::vector<std::shared_ptr<Viewer>>&, const RunRecord&) {}
void show_results_until_stopped(const std::filesystem::path&, const std::string&, int) { throw PluginError(reason); }

}  // namespace holdfast
