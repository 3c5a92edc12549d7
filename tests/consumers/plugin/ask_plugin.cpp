// SPDX-License-Identifier: BSD-3-Clause
// ask_plugin NAME_OR_PATH: loads the plugin and lets its filter judge two features.
#include <iostream>

#include "holdfast/core/map.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/plugin/loader.hpp"

int main(int argument_count, char** arguments) {
  if (argument_count != 2) return 2;
  try {
    holdfast::Registry registry;
    holdfast::load_plugin(registry, arguments[1]);
    const holdfast::ModuleEntry* entry = registry.find("filters", "upper_half");
    if (!entry) return 3;
    std::cout << entry->description.name << " from " << entry->origin << '\n';

    holdfast::CreationContext context;
    context.camera.height = 100;
    const auto filter = registry.create<holdfast::DynamicFilter>("upper_half", {{"log_odds", -3.0}}, context);

    holdfast::Frame frame;
    frame.features.resize(2);
    frame.x = {10.0F, 10.0F};
    frame.y = {49.0F, 51.0F};
    const holdfast::SensorFrame sensor_frame;
    const holdfast::Map map;
    holdfast::StaticEvidence evidence(frame.size());
    evidence.begin_stage("upper_half");
    filter->apply({.sensor_frame = sensor_frame, .frame = frame, .map = map}, evidence);
    std::cout << "evidence " << evidence.log_odds(0) << ' ' << evidence.log_odds(1) << '\n';
    return evidence.log_odds(0) == -3.0F && evidence.log_odds(1) == 0.0F ? 0 : 4;
  } catch (const holdfast::Error& error) {
    std::cerr << error.what() << '\n';
    return 5;
  }
}
