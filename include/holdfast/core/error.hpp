// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "holdfast/core/check.hpp"

namespace holdfast {

/// Base class of all exceptions that Holdfast throws. The message states what was found, what was expected and how to
/// correct it. Per-frame failures (no depth, no features, lost) are not exceptions but typed results
/// (frame_result.hpp).
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A position in a text file, counted from 1; line 0 denotes the whole file, column 0 the whole line.
struct SourceLocation {
  std::string file;
  int line = 0;
  int column = 0;

  /// Returns "file:line:column" without the unknown parts.
  std::string to_string() const;
};

/// One error in a configuration.
struct Diagnostic {
  SourceLocation location;
  std::string message;

  std::string to_string() const;
};

/// Thrown for a configuration that cannot be run. It holds all errors found, not only the first; what() lists one per
/// line.
class ConfigurationError : public Error {
 public:
  explicit ConfigurationError(std::vector<Diagnostic> diagnostics);
  ConfigurationError(SourceLocation location, std::string message);
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

/// Thrown for an input file or frame that cannot be used: missing, truncated, or of the wrong type or size.
class InputError : public Error {
 public:
  InputError(SourceLocation location, const std::string& message);
  const SourceLocation& location() const { return location_; }

 private:
  SourceLocation location_;
};

/// Thrown for a plugin that cannot be loaded or is incompatible with this build.
class PluginError : public Error {
 public:
  using Error::Error;
};

}  // namespace holdfast
