// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/error.hpp"

namespace holdfast {

/// Arguments of a command that do not go together. The program exits with 2, as for arguments that it cannot read.
class UsageError : public Error {
 public:
  using Error::Error;
};

}  // namespace holdfast
