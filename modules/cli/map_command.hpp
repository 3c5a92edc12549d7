// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace CLI {
class App;
}

namespace holdfast {

/// Adds `map info FILE` and `map export FILE` to the program. When one of them runs, its exit code goes into
/// `exit_code`, which must outlive the parsing: 0 when it was done, 1 otherwise, with the reason on stderr.
void add_map_command(CLI::App& app, int& exit_code);

}  // namespace holdfast
