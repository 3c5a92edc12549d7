// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/warning.hpp"
#include "holdfast/run/run_record.hpp"

namespace holdfast {

/// Suspicions that the figures of a whole run raise; see core/warning.hpp.
Warnings find_warnings(const RunRecord& record);

}  // namespace holdfast
