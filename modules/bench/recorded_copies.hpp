// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "holdfast/bench/run_scheduler.hpp"

namespace holdfast {

/// The folder of a copy.
std::filesystem::path folder_of(const RecordedCopy& copy, const std::filesystem::path& output);

/// Makes the copies that some runs of the plan need and that are not there, one after the other by `holdfast record`.
/// A copy is made in a hidden folder that is renamed when it is complete, so that several processes can need the same
/// one. Returns false if `options.stop` ended it. Throws InputError with the end of the log if one cannot be made.
bool make_copies(const RunPlan& plan, const std::vector<std::size_t>& runs, const BenchOptions& options);

/// Removes all copies, and those that were not completed.
void remove_copies(const std::filesystem::path& output);

/// A complete copy as external systems get it. Throws InputError.
RecordedSequence read_copy(const RecordedCopy& copy, const std::filesystem::path& output);

}  // namespace holdfast
