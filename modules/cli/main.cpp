// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.hpp"

int main(int argc, char** argv) { return holdfast::run_program(argc, argv); }
