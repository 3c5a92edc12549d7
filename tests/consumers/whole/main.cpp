// SPDX-License-Identifier: BSD-3-Clause
// consumer CONFIG: feeds the first frames of a configured source and counts the poses.
#include "holdfast/holdfast.hpp"

#include <iostream>

int main(int argument_count, char** arguments) {
  if (argument_count != 2) return 2;
  try {
    holdfast::Registry registry;
    holdfast::register_builtin_plugins(registry);
    const holdfast::Configuration configuration =
        holdfast::load_configuration(arguments[1], {}, registry, holdfast::pipeline_sections());
    holdfast::BuiltPipeline built = holdfast::build_pipeline(configuration, registry);
    for (int i = 0; i < 3; ++i)
      if (const auto frame = built.source->next()) built.pipeline.feed(*frame);
    built.pipeline.finish();
    std::cout << built.pipeline.trajectory().size() << " poses\n";
    return built.pipeline.trajectory().size() == 3 ? 0 : 3;
  } catch (const holdfast::Error& error) {
    std::cerr << error.what() << '\n';
    return 4;
  }
}
