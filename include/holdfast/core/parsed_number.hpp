// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace holdfast {

/// The number that is the whole of a text, in the C locale: no blanks, no plus sign. Nothing if the text is anything
/// else, or if the number does not fit its type. A floating-point number may be infinite or NaN.
template <class Number>
std::optional<Number> parsed_number(std::string_view text) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end) return std::nullopt;
  return number;
}

}  // namespace holdfast
