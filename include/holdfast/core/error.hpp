// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace holdfast {

/// Base of everything Holdfast throws. The message names what was found, what was expected and what to do.
/// Per-frame trouble (no depth, no features, lost) is never an exception; it is a typed result (frame_result.hpp).
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A place in a text file, counted from 1; line or column 0 means "the whole file" or "the whole line".
struct SourceLocation {
  std::string file;
  int line = 0;
  int column = 0;

  /// "file:line:column", leaving out what is unknown.
  std::string to_string() const;
};

/// One thing that is wrong with a configuration.
struct Diagnostic {
  SourceLocation location;
  std::string message;

  std::string to_string() const;
};

/// A configuration that cannot be run. Carries every problem found, not just the first; what() lists them line by line.
class ConfigurationError : public Error {
 public:
  explicit ConfigurationError(std::vector<Diagnostic> diagnostics);
  ConfigurationError(SourceLocation location, std::string message);
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

/// An input file or frame that cannot be used: missing, truncated, of the wrong type or size.
class InputError : public Error {
 public:
  InputError(SourceLocation location, const std::string& message);
  const SourceLocation& location() const { return location_; }

 private:
  SourceLocation location_;
};

/// A plugin that cannot be loaded or does not fit this build.
class PluginError : public Error {
 public:
  using Error::Error;
};

/// A broken promise between parts of the program; always a defect in the calling code.
class CheckError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

namespace detail {
[[noreturn]] void check_failed(const char* file, int line, const char* expression, const std::string& values);
}  // namespace detail

/// HOLDFAST_CHECK(i < n, "i " << i << " n " << n): throws CheckError with the place, the condition and the values.
#define HOLDFAST_CHECK(condition, values)                                                            \
  do {                                                                                               \
    if (!(condition)) [[unlikely]] {                                                                 \
      std::ostringstream holdfast_check_stream;                                                      \
      holdfast_check_stream << values;                                                               \
      ::holdfast::detail::check_failed(__FILE__, __LINE__, #condition, holdfast_check_stream.str()); \
    }                                                                                                \
  } while (false)

}  // namespace holdfast
