// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cerrno>
#include <string>
#include <system_error>

namespace holdfast {

/// The system's message for an error number (errno), such as "No space left on device".
inline std::string system_reason(int error) { return std::generic_category().message(error); }

}  // namespace holdfast
