// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/build_layout.hpp"

namespace holdfast::build_layout {

template <>
const char ThisBuildLayout::is_that_of_the_library = 1;

}  // namespace holdfast::build_layout
