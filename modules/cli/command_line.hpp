// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "program_host.hpp"

namespace CLI {
class App;
}

namespace holdfast {

/// The program: reads the arguments, runs the command and returns the exit code. Errors are printed as "error: ..."
/// lines on standard error. `host` says what modules there are and how to start the program. 2: arguments or a
/// configuration are wrong; 1: any other error; else what the command says.
int run_program(int argument_count, const char* const* arguments, const ProgramHost& host = {});

/// Adds every command to `app`. exit_code is set when a command ran. Both must live as long as `app`.
void add_commands(CLI::App& app, int& exit_code, const ProgramHost& host = {});

}  // namespace holdfast
