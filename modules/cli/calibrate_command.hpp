// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "program_host.hpp"

namespace CLI {
class App;
}

namespace holdfast {

/// `holdfast calibrate`: finds the numbers of a camera from pictures of a board.
void add_calibrate_command(CLI::App& app, int& exit_code, const ProgramHost& host);

}  // namespace holdfast
