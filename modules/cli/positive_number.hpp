// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <string>

namespace holdfast {

/// Accepts finite numbers above zero. CLI11's own check prints the largest number that there is, with all its digits.
inline CLI::Validator positive_number() {
  return CLI::Validator(
      [](const std::string& text) {
        double number = 0.0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        const bool is_number = error == std::errc() && end == text.data() + text.size() && std::isfinite(number);
        return is_number && number > 0.0 ? std::string() : "found '" + text + "'; expected a number above 0";
      },
      "");
}

}  // namespace holdfast
