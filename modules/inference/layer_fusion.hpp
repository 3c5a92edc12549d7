// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "network_plan.hpp"

namespace holdfast {

/// Joins an Add or an activation that alone reads a convolution's result to that convolution, so that the result is not
/// written and read again. The joined layer takes the later one's place in the order.
void join_layers(NetworkPlan& plan);

}  // namespace holdfast
