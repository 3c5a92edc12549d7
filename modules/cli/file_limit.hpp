// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

/// Lets a write beyond the limit of the size of files (`ulimit -f`) fail as one to a full disk does. Without this the
/// system ends the program (SIGXFSZ), which leaves temporary files and no message. Programs that this one starts are
/// not concerned.
void survive_file_limit();

}  // namespace holdfast
