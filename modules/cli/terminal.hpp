// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/core/stage_times.hpp"

namespace holdfast {

/// True when the stream (STDOUT_FILENO, STDERR_FILENO) is a terminal that obeys control characters: TERM is not "dumb".
bool obeys_control_characters(int stream);

/// Text in bold or a colour when the stream obeys control characters and NO_COLOR is unset or empty; plain otherwise.
std::string bold(const std::string& text, int stream);
std::string red(const std::string& text, int stream);
std::string green(const std::string& text, int stream);
std::string yellow(const std::string& text, int stream);

/// Text of several lines with the label of each in bold: what stands before two blanks or more, or a whole line that
/// ends with a colon. Indentation stays.
std::string bold_labels(const std::string& text, int stream);

/// Text with control characters written out, such as \x1b, so that a name from a file cannot command the terminal; line
/// feeds and tabs stay.
std::string printable(const std::string& text);

/// What is wrong, on standard error: one line "error: ..." for every command alike. Control characters of the message
/// are written out.
void print_error(const std::string& message);
/// What may be unintended, on standard error.
void print_warning(const std::string& message);
void print_warnings(const std::vector<Diagnostic>& warnings);

/// Frames done, frames per second and time left, on standard error: one line that is written over on a terminal that
/// obeys control characters, a line every ten seconds elsewhere. The line of a terminal is cleared at the end.
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
  bool terminal_;  ///< one that obeys control characters
  Stopwatch watch_;
  double next_ = 0.0;
};

/// The text of a progress line: "frame 20 of 100, 9.8 frames/s, 8 s left, tracked". Without `total` the time left is
/// unknown and left out, without `note` that is.
std::string progress_text(std::uint64_t done, std::optional<std::uint64_t> total, double seconds,
                          const std::string& note);

/// Turns SIGINT, SIGTERM and SIGHUP into a question that long work asks. A second SIGINT or SIGTERM ends the program at
/// once. A SIGHUP that is ignored, as under `nohup`, stays ignored.
void catch_interrupts();
bool interrupted();
/// What a program exits with after a signal, by custom 128 and its number: 130 after SIGINT, 143 after SIGTERM. SIGHUP
/// counts as SIGTERM.
int interrupted_exit_code();

}  // namespace holdfast
