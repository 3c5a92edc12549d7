// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/core/stage_times.hpp"

namespace holdfast {

/// Text in bold, red or green when the stream is a terminal and NO_COLOR is not set; plain otherwise.
std::string bold(const std::string& text, int stream);
std::string red(const std::string& text, int stream);
std::string green(const std::string& text, int stream);

/// Text with control characters written out, such as \x1b, so that a name from a file cannot command the terminal; line
/// feeds and tabs stay.
std::string printable(const std::string& text);
/// What may be unintended, on standard error.
void print_warnings(const std::vector<Diagnostic>& warnings);

/// Frames done and time left, on standard error: one line that is written over on a terminal, a line every ten seconds
/// elsewhere. The line of a terminal is cleared at the end.
class Progress {
 public:
  /// `total`: nothing when it is not known.
  explicit Progress(std::optional<std::uint64_t> total, bool quiet = false);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `note` is shown after the counts.
  void update(std::uint64_t done, const std::string& note = {});

 private:
  std::optional<std::uint64_t> total_;
  bool quiet_;
  bool terminal_;
  Stopwatch watch_;
  double next_ = 0.0;
};

/// Turns SIGINT and SIGTERM into a question that long work asks; a second signal ends the program at once.
void catch_interrupts();
bool interrupted();
/// What a program exits with after SIGINT, by custom.
constexpr int interrupted_exit_code = 130;

}  // namespace holdfast
