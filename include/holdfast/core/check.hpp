// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace holdfast {

/// Thrown when a precondition is violated; always a defect in the calling code.
class CheckError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

namespace detail {
[[noreturn]] inline void check_failed(const char* file, int line, const char* expression, const std::string& values) {
  std::ostringstream message;
  message << file << ':' << line << ": check failed: " << expression << " with " << values;
  throw CheckError(message.str());
}
}  // namespace detail

/// HOLDFAST_CHECK(i < n, "i " << i << " n " << n): throws CheckError with file, line, condition and values if
/// the condition is false.
#define HOLDFAST_CHECK(condition, values)                                                            \
  do {                                                                                               \
    if (!(condition)) [[unlikely]] {                                                                 \
      std::ostringstream holdfast_check_stream;                                                      \
      holdfast_check_stream << values;                                                               \
      ::holdfast::detail::check_failed(__FILE__, __LINE__, #condition, holdfast_check_stream.str()); \
    }                                                                                                \
  } while (false)

}  // namespace holdfast
