// SPDX-License-Identifier: BSD-3-Clause
// ten_lines CONFIG TRAJECTORY: tracks the camera with the pipeline of a configuration and writes its trajectory.
#include <iostream>

#include "holdfast/holdfast.hpp"

int main(int argument_count, char** arguments) try {
  if (argument_count != 3) throw holdfast::Error("usage: ten_lines CONFIG TRAJECTORY");
  auto [source, pipeline] = holdfast::build_pipeline(holdfast::load_configuration(arguments[1]));
  while (const auto frame = source->next()) pipeline.feed(*frame);
  pipeline.finish();
  holdfast::write_trajectory(arguments[2], pipeline.trajectory());
} catch (const holdfast::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
