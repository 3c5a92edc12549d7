// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace CLI {
class App;
}

namespace holdfast {

struct ProgramHost;

/// Adds `holdfast segment CONFIG --output DIR` to the program: the configured segmenter over the frames of the
/// configured source, written so that the segmenter `precomputed` reads them back. exit_code is set when the command
/// ran.
void add_segment_command(CLI::App& app, int& exit_code, const ProgramHost& host);

}  // namespace holdfast
