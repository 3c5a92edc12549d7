// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace CLI {
class App;
}

namespace holdfast {

/// Adds `holdfast dataset list|check|associate` to the program. exit_code is set when a command ran.
void add_dataset_command(CLI::App& app, int& exit_code);

}  // namespace holdfast
