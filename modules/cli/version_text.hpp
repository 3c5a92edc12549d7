// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace holdfast {

/// "holdfast 0.1.0", then a line each with commit, compiler, libraries and the SIMD level of this process.
std::string version_text();

}  // namespace holdfast
