// SPDX-License-Identifier: BSD-3-Clause
#include "commit.hpp"
#include "holdfast/run/results.hpp"

namespace holdfast {

const char* build_commit() { return HOLDFAST_COMMIT; }

}  // namespace holdfast
