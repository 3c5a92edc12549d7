// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace CLI {
class App;
}

namespace holdfast {

struct ProgramHost;

/// Adds `evaluate-segmentation` to the program: label images, or what a configured segmenter finds, compared with true
/// labels. exit_code is set when the command ran.
void add_evaluate_segmentation_command(CLI::App& app, int& exit_code, const ProgramHost& host);

}  // namespace holdfast
