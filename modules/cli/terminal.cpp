// SPDX-License-Identifier: BSD-3-Clause
#include "terminal.hpp"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>

namespace holdfast {

namespace {

std::string coloured(const std::string& text, const char* code, int stream) {
  if (isatty(stream) != 1 || std::getenv("NO_COLOR") != nullptr) return text;
  return std::string("\033[") + code + "m" + text + "\033[0m";
}

std::string time_text(double seconds) {
  char text[32];
  if (seconds < 100.0)
    std::snprintf(text, sizeof(text), "%.0f s", seconds);
  else
    std::snprintf(text, sizeof(text), "%d min %02d s", static_cast<int>(seconds) / 60, static_cast<int>(seconds) % 60);
  return text;
}

volatile std::sig_atomic_t interrupt_seen = 0;

}  // namespace

std::string bold(const std::string& text, int stream) { return coloured(text, "1", stream); }
std::string red(const std::string& text, int stream) { return coloured(text, "31", stream); }
std::string green(const std::string& text, int stream) { return coloured(text, "32", stream); }

std::string printable(const std::string& text) {
  constexpr const char* digits = "0123456789abcdef";
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    // U+0080 to U+009F are control characters as well, of two bytes in UTF-8.
    const bool is_second = byte >= 0x80 && byte < 0xa0 && i > 0 && text[i - 1] == '\xc2';
    const bool is_control = (byte < 0x20 && byte != '\n' && byte != '\t') || byte == 0x7f || is_second;
    if (is_second) result.pop_back();
    if (is_control)
      (result += "\\x") += {digits[byte >> 4], digits[byte & 15]};
    else
      result += text[i];
  }
  return result;
}

void print_warnings(const std::vector<Diagnostic>& warnings) {
  for (const Diagnostic& warning : warnings)
    std::fprintf(stderr, "%s %s\n", bold("warning:", STDERR_FILENO).c_str(), printable(warning.to_string()).c_str());
}

Progress::Progress(std::optional<std::uint64_t> total, bool quiet)
    : total_(total), quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1), next_(terminal_ ? 0.0 : 10.0) {}

Progress::~Progress() {
  if (terminal_ && !quiet_) std::fputs("\r\033[K", stderr);
}

void Progress::update(std::uint64_t done, const std::string& note) {
  if (quiet_ || watch_.seconds() < next_) return;
  next_ = watch_.seconds() + (terminal_ ? 0.2 : 10.0);
  std::string text = "frame " + std::to_string(done);
  if (total_ && done > 0) {
    const double per_frame = watch_.seconds() / static_cast<double>(done);
    const double left = *total_ > done ? per_frame * static_cast<double>(*total_ - done) : 0.0;
    text += " of " + std::to_string(*total_) + ", " + time_text(left) + " left";
  }
  if (!note.empty()) text += ", " + note;
  std::fprintf(stderr, terminal_ ? "\r\033[K%s" : "%s\n", text.c_str());
  std::fflush(stderr);
}

void catch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = [](int) { interrupt_seen = 1; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // the second one ends the program
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() { return interrupt_seen != 0; }

}  // namespace holdfast
