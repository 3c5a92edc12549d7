// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "command_line.hpp"

namespace holdfast::test {

struct CommandOutcome {
  int exit_code = -1;
  std::string output, errors;
};

/// The program in this process, with what it printed.
inline CommandOutcome run_command(const std::vector<std::string>& words) {
  std::vector<const char*> arguments = {"holdfast"};
  for (const std::string& word : words) arguments.push_back(word.c_str());
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  CommandOutcome outcome;
  outcome.exit_code = run_program(static_cast<int>(arguments.size()), arguments.data());
  std::fflush(stdout);
  std::fflush(stderr);
  outcome.output = ::testing::internal::GetCapturedStdout();
  outcome.errors = ::testing::internal::GetCapturedStderr();
  return outcome;
}

}  // namespace holdfast::test
