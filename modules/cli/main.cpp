// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.hpp"
#include "free_memory.hpp"

int main(int argc, char** argv) {
  holdfast::limit_free_memory();
  return holdfast::run_program(argc, argv);
}
