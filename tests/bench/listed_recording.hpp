// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <string>

#include "cli/program.hpp"

namespace holdfast::test {

/// Writes a recording of 60 frames in TUM layout of which only the lists are there: for programs that do not look at
/// the images.
inline void write_listed_recording(const Program& program, const std::string& folder) {
  std::filesystem::create_directories(program.path(folder));
  std::string colour, depth, truth;
  for (int i = 0; i < 60; ++i) {
    char line[200];
    std::snprintf(line, sizeof(line), "%.6f rgb/%d.png\n", 100.0 + 0.1 * i, i);
    colour += line;
    std::snprintf(line, sizeof(line), "%.6f depth/%d.png\n", 100.005 + 0.1 * i, i);
    depth += line;
    std::snprintf(line, sizeof(line), "%.6f %d %d 1.5 0 0 0 1\n", 100.0 + 0.1 * i, i % 7, i % 3);
    truth += line;
  }
  program.write(folder + "/rgb.txt", colour);
  program.write(folder + "/depth.txt", depth);
  program.write(folder + "/groundtruth.txt", truth);
}

}  // namespace holdfast::test
