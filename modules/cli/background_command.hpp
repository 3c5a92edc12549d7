// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace CLI {
class App;
}

namespace holdfast {

struct ProgramHost;

/// Adds `holdfast background CONFIG --output DIR` to the program: runs the pipeline and writes keyframes' pictures
/// before and after what moves was replaced by what other keyframes saw behind it. exit_code is set when the command
/// ran.
void add_background_command(CLI::App& app, int& exit_code, const ProgramHost& host);

}  // namespace holdfast
