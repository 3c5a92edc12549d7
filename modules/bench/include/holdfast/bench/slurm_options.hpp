// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/bench/matrix.hpp"
#include "holdfast/bench/run_scheduler.hpp"

namespace holdfast {

/// Sets an option by its name: partition, account, time, memory, constraint, processors, array_size, poll_seconds.
/// Errors are appended to `diagnostics`.
void set_slurm_option(const std::string& name, const PlacedText& value, SlurmOptions& options,
                      std::vector<Diagnostic>& diagnostics);

}  // namespace holdfast
