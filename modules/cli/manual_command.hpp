// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace CLI {
class App;
}

namespace holdfast {

/// Adds `holdfast manual` to the program. exit_code is set when the command ran.
void add_manual_command(CLI::App& app, int& exit_code);

}  // namespace holdfast
