// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace CLI {
class App;
}

namespace holdfast {

/// Adds `evaluate-surface TRUTH MESH` to the program; `exit_code` must outlive the parsing.
void add_evaluate_surface_command(CLI::App& app, int& exit_code);

}  // namespace holdfast
