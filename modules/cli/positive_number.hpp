// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

#include "holdfast/core/parsed_number.hpp"

namespace holdfast {

/// Accepts finite numbers above zero. CLI11's own check prints the largest number that there is, with all its digits.
inline CLI::Validator positive_number() {
  return CLI::Validator(
      [](const std::string& text) {
        const auto number = parsed_number<double>(text);
        return number && std::isfinite(*number) && *number > 0.0 ? std::string()
                                                                 : "found '" + text + "'; expected a number above 0";
      },
      "");
}

}  // namespace holdfast
