// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace CLI {
class App;
}

namespace holdfast {

/// Adds `evaluate TRUTH ESTIMATE` to the program. When the command runs, its exit code goes into `exit_code`, which
/// must outlive the parsing: 0 when the figures were computed and written, 1 otherwise, with the reason on stderr.
void add_evaluate_command(CLI::App& app, int& exit_code);

}  // namespace holdfast
