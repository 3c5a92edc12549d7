// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "check.hpp"

namespace holdfast::conformance {

/// The part of optimizer_checks() about factors; an optimizer without them must refuse such problems.
std::vector<Check> optimizer_factor_checks();

}  // namespace holdfast::conformance
