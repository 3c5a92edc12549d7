// SPDX-License-Identifier: BSD-3-Clause
// ten_lines CONFIG TRAJECTORY: tracks what a configuration says and writes the path of the camera.
#include <iostream>

#include "holdfast/holdfast.hpp"

int main(int argument_count, char** arguments) try {
  if (argument_count != 3) throw holdfast::Error("usage: ten_lines CONFIG TRAJECTORY");
  holdfast::Registry registry;
  holdfast::register_builtin_plugins(registry);
  const auto configuration = holdfast::load_configuration(arguments[1], {}, registry, holdfast::pipeline_sections());
  auto [source, pipeline] = holdfast::build_pipeline(configuration, registry);
  while (const auto frame = source->next()) pipeline.feed(*frame);
  pipeline.finish();
  holdfast::write_trajectory(arguments[2], pipeline.trajectory());
} catch (const holdfast::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
