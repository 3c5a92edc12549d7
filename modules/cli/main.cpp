// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.hpp"
#include "file_limit.hpp"
#include "free_memory.hpp"

int main(int argc, char** argv) {
  holdfast::limit_free_memory();
  holdfast::survive_file_limit();
  return holdfast::run_program(argc, argv);
}
