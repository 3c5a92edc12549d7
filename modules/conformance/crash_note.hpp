// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace holdfast::conformance {

/// While it lives, a crash of this process first writes the text to stderr, so that even then it is known which promise
/// was broken. Signals that are handled elsewhere (by a sanitizer) are not changed.
class CrashNote {
 public:
  explicit CrashNote(const std::string& text);
  ~CrashNote();
  CrashNote(const CrashNote&) = delete;
  CrashNote& operator=(const CrashNote&) = delete;
};

}  // namespace holdfast::conformance
