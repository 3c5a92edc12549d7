// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace CLI {
class App;
}

namespace holdfast {

/// Adds `simulate --output DIR`: writes a sequence from the simulated room in the layout of the TUM RGB-D benchmark
/// (rgb/, depth/ with 5000 units to the metre, rgb.txt, depth.txt, associations.txt, groundtruth.txt), and scene.json
/// with all that was drawn. Lists are written last and every file in one step, so an interrupted run leaves no list
/// that names a missing image. Sets exit_code to 0 on success; throws Error for a folder that is not empty (without
/// --overwrite), an unknown camera or a file that cannot be written.
void add_simulate_command(CLI::App& app, int& exit_code);

}  // namespace holdfast
