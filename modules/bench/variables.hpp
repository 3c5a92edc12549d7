// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/bench/matrix.hpp"

namespace holdfast {

/// Replaces every ${NAME} whose variable is set and not empty; what a value holds is not looked at again.
void expand_variables(std::string& text, const Variables& variables);
/// The same in every scalar of a tree.
void expand_variables(ConfigurationNode& node, const Variables& variables);

}  // namespace holdfast
