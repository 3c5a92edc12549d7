// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace CLI {
class App;
}

namespace holdfast {

struct ProgramHost;

/// Adds `holdfast bench` to the program. exit_code is set when the command ran.
void add_bench_command(CLI::App& app, int& exit_code, const ProgramHost& host);

}  // namespace holdfast
