// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "program_host.hpp"

namespace CLI {
class App;
}

namespace holdfast {

/// `holdfast record`: writes the frames of a source as a recording.
void add_record_command(CLI::App& app, int& exit_code, const ProgramHost& host);

}  // namespace holdfast
