// SPDX-License-Identifier: BSD-3-Clause
#include "terminal.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

namespace holdfast {
namespace {

/// A terminal that nobody looks at.
class PseudoTerminal {
 public:
  PseudoTerminal() : master_(posix_openpt(O_RDWR | O_NOCTTY)) {
    if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0) return;
    stream_ = open(ptsname(master_), O_RDWR | O_NOCTTY);
  }
  ~PseudoTerminal() {
    close(stream_);
    close(master_);
  }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  int stream() const { return stream_; }

 private:
  int master_;
  int stream_ = -1;
};

TEST(Terminal, ADumbOneGetsNoControlCharacters) {
  const PseudoTerminal terminal;
  if (terminal.stream() < 0) GTEST_SKIP() << "this system gives no pseudo terminals";
  const char* before = std::getenv("TERM");
  const std::string kept = before != nullptr ? before : "";
  unsetenv("NO_COLOR");
  setenv("TERM", "xterm", 1);
  EXPECT_TRUE(obeys_control_characters(terminal.stream()));
  EXPECT_EQ(red("text", terminal.stream()), "\033[31mtext\033[0m");
  setenv("TERM", "dumb", 1);
  EXPECT_FALSE(obeys_control_characters(terminal.stream()));
  EXPECT_EQ(red("text", terminal.stream()), "text");
  before != nullptr ? setenv("TERM", kept.c_str(), 1) : unsetenv("TERM");
}

/// https://no-color.org: set and not empty.
TEST(Terminal, ColoursAreForTerminalsThatAreNotAskedToDoWithout) {
  const PseudoTerminal terminal;
  if (terminal.stream() < 0) GTEST_SKIP() << "this system gives no pseudo terminals";
  const char* before = std::getenv("TERM");
  const std::string kept = before != nullptr ? before : "";
  setenv("TERM", "xterm", 1);
  setenv("NO_COLOR", "1", 1);
  EXPECT_EQ(yellow("text", terminal.stream()), "text");
  EXPECT_EQ(bold_labels("a  b\n", terminal.stream()), "a  b\n");
  setenv("NO_COLOR", "", 1);
  EXPECT_EQ(yellow("text", terminal.stream()), "\033[33mtext\033[0m");
  EXPECT_EQ(bold_labels("ATE RMSE   0.1 m\n  orb  Features  of FAST\nkinds:\n\nplain text\nno end", terminal.stream()),
            "\033[1mATE RMSE\033[0m   0.1 m\n  \033[1morb\033[0m  Features  of FAST\n\033[1mkinds:\033[0m\n\nplain "
            "text\nno end");
  unsetenv("NO_COLOR");
  before != nullptr ? setenv("TERM", kept.c_str(), 1) : unsetenv("TERM");
}

TEST(Terminal, AFileIsNone) {
  const int file = open("/dev/null", O_WRONLY);
  EXPECT_FALSE(obeys_control_characters(file));
  EXPECT_EQ(bold("text", file), "text");
  close(file);
}

TEST(Terminal, ProgressHasFramesPerSecondAndTheTimeLeft) {
  EXPECT_EQ(progress_text(20, 100, 2.0, "tracked"), "frame 20 of 100, 10.0 frames/s, 8 s left, tracked");
  EXPECT_EQ(progress_text(20, std::nullopt, 2.0, ""), "frame 20, 10.0 frames/s");
  EXPECT_EQ(progress_text(1, 3001, 0.5, ""), "frame 1 of 3001, 2.0 frames/s, 25 min 00 s left");
  EXPECT_EQ(progress_text(0, 100, 0.0, ""), "frame 0 of 100");
  EXPECT_EQ(progress_text(120, 100, 2.0, ""), "frame 120 of 100, 60.0 frames/s, 0 s left");
}

}  // namespace
}  // namespace holdfast
