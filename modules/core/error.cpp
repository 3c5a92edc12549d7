// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/error.hpp"

#include <utility>

namespace holdfast {

std::string SourceLocation::to_string() const {
  std::string text = file;
  if (line > 0) {
    if (!text.empty()) text += ':';
    text += std::to_string(line);
  }
  if (line > 0 && column > 0) text += ':' + std::to_string(column);
  return text;
}

std::string Diagnostic::to_string() const {
  const std::string place = location.to_string();
  return place.empty() ? message : place + ": " + message;
}

namespace {
std::string join(const std::vector<Diagnostic>& diagnostics) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics) {
    if (!text.empty()) text += '\n';
    text += diagnostic.to_string();
  }
  return text;
}
}  // namespace

ConfigurationError::ConfigurationError(std::vector<Diagnostic> diagnostics)
    : Error(join(diagnostics)), diagnostics_(std::move(diagnostics)) {}

ConfigurationError::ConfigurationError(SourceLocation location, std::string message)
    : ConfigurationError(std::vector<Diagnostic>{{std::move(location), std::move(message)}}) {}

InputError::InputError(SourceLocation location, const std::string& message)
    : Error(Diagnostic{location, message}.to_string()), location_(std::move(location)) {}

}  // namespace holdfast
