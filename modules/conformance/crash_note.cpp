// SPDX-License-Identifier: BSD-3-Clause
#include "crash_note.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>

namespace holdfast::conformance {

namespace {

constexpr std::array signals{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

// Only what a signal handler may touch.
std::array<char, 2048> note;
std::size_t note_size = 0;

void tell(int) {
  // SA_RESETHAND: coming back from here repeats what crashed, and it ends the process as it would have without us.
  [[maybe_unused]] const auto written = write(STDERR_FILENO, note.data(), note_size);
}

}  // namespace

CrashNote::CrashNote(const std::string& text) {
  note_size = std::min(text.size(), note.size());
  std::copy_n(text.begin(), note_size, note.begin());
  for (const int signal : signals) {
    struct sigaction action = {};
    if (sigaction(signal, nullptr, &action) != 0 || action.sa_handler != SIG_DFL) continue;
    action.sa_handler = tell;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(signal, &action, nullptr);
  }
}

CrashNote::~CrashNote() {
  for (const int signal : signals) {
    struct sigaction action = {};
    if (sigaction(signal, nullptr, &action) != 0 || action.sa_handler != tell) continue;
    action.sa_handler = SIG_DFL;
    sigaction(signal, &action, nullptr);
  }
}

}  // namespace holdfast::conformance
