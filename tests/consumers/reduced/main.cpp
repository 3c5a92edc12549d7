// SPDX-License-Identifier: BSD-3-Clause
// Names the plugins that are built in, and prints the error for one that was left out.
#include <iostream>

#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "holdfast/settings/all.hpp"

int main() {
  holdfast::Registry registry;
  holdfast::register_builtin_plugins(registry);
  for (const std::string& kind : registry.kinds())
    for (const std::string& name : registry.names(kind)) std::cout << kind << '/' << name << '\n';
  try {
    registry.create<holdfast::Optimizer>("ceres", {}, {});
  } catch (const holdfast::PluginError& error) {
    std::cout << error.what() << '\n';
  }
  return holdfast::OrbSettings{}.count > 0 ? 0 : 1;
}
