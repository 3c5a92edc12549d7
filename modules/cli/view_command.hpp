// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace CLI {
class App;
}

namespace holdfast {

/// `holdfast view`: a run that has ended, or a map, in the browser.
void add_view_command(CLI::App& app, int& exit_code);

}  // namespace holdfast
