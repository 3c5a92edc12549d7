// SPDX-License-Identifier: BSD-3-Clause
#include "terminal.hpp"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace holdfast {

namespace {

bool shows_colours(int stream) {
  const char* no_colour = std::getenv("NO_COLOR");
  return obeys_control_characters(stream) && (no_colour == nullptr || *no_colour == '\0');
}

std::string coloured(const std::string& text, const char* code, int stream) {
  if (!shows_colours(stream)) return text;
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

volatile std::sig_atomic_t signal_seen = 0;

}  // namespace

bool obeys_control_characters(int stream) {
  const char* terminal = std::getenv("TERM");
  return isatty(stream) == 1 && (terminal == nullptr || std::string_view(terminal) != "dumb");
}

std::string bold(const std::string& text, int stream) { return coloured(text, "1", stream); }
std::string red(const std::string& text, int stream) { return coloured(text, "31", stream); }
std::string green(const std::string& text, int stream) { return coloured(text, "32", stream); }
std::string yellow(const std::string& text, int stream) { return coloured(text, "33", stream); }

std::string bold_labels(const std::string& text, int stream) {
  if (!shows_colours(stream)) return text;
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    const std::size_t label = line.find_first_not_of(' ');
    std::size_t label_end = label == std::string::npos ? label : line.find("  ", label);
    if (label_end == std::string::npos && line.ends_with(':')) label_end = line.size();
    if (label == std::string::npos || label_end == std::string::npos)
      result += line;
    else
      result += line.substr(0, label) + bold(line.substr(label, label_end - label), stream) + line.substr(label_end);
    if (end < text.size()) result += '\n';
    begin = end + 1;
  }
  return result;
}

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

void print_error(const std::string& message) {
  std::fprintf(stderr, "%s %s\n", red("error:", STDERR_FILENO).c_str(), printable(message).c_str());
}

void print_warning(const std::string& message) {
  std::fprintf(stderr, "%s %s\n", yellow("warning:", STDERR_FILENO).c_str(), printable(message).c_str());
}

void print_warnings(const std::vector<Diagnostic>& warnings) {
  for (const Diagnostic& warning : warnings) print_warning(warning.to_string());
}

std::string progress_text(std::uint64_t done, std::optional<std::uint64_t> total, double seconds,
                          const std::string& note) {
  std::string text = "frame " + std::to_string(done);
  if (total) text += " of " + std::to_string(*total);
  if (done > 0 && seconds > 0.0) {
    char rate[48];
    std::snprintf(rate, sizeof(rate), ", %.1f frames/s", static_cast<double>(done) / seconds);
    text += rate;
  }
  if (total && done > 0) {
    const double left = *total > done ? seconds / static_cast<double>(done) * static_cast<double>(*total - done) : 0.0;
    text += ", " + time_text(left) + " left";
  }
  return note.empty() ? text : text + ", " + note;
}

Progress::Progress(std::optional<std::uint64_t> total, bool quiet)
    : total_(total), quiet_(quiet), terminal_(obeys_control_characters(STDERR_FILENO)), next_(terminal_ ? 0.0 : 10.0) {}

Progress::~Progress() {
  if (terminal_ && !quiet_) std::fputs("\r\033[K", stderr);
}

void Progress::update(std::uint64_t done, const std::string& note) {
  if (quiet_ || watch_.seconds() < next_) return;
  next_ = watch_.seconds() + (terminal_ ? 0.2 : 10.0);
  const std::string text = printable(progress_text(done, total_, watch_.seconds(), note));
  std::fprintf(stderr, terminal_ ? "\r\033[K%s" : "%s\n", text.c_str());
  std::fflush(stderr);
}

void catch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = [](int signal) { signal_seen = signal; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // the second one ends the program
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction earlier = {};
  sigaction(SIGHUP, nullptr, &earlier);
  if (earlier.sa_handler == SIG_IGN) return;
  action.sa_flags = 0;  // shell and system may both send it when a terminal is closed
  sigaction(SIGHUP, &action, nullptr);
}

bool interrupted() { return signal_seen != 0; }

int interrupted_exit_code() { return 128 + (signal_seen == SIGHUP ? SIGTERM : static_cast<int>(signal_seen)); }

}  // namespace holdfast
