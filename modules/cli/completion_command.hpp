// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "program_host.hpp"

namespace CLI {
class App;
}

namespace holdfast {

/// Adds `holdfast completion` to the program; `host` has the modules whose names are completed. exit_code is set when
/// the command ran.
void add_completion_command(CLI::App& app, int& exit_code, const ProgramHost& host);

}  // namespace holdfast
