// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "holdfast/plugin/registry.hpp"

namespace holdfast::bad {

/// Registers one module per fault, called like it: each is sound but for that. "sound" has none.
template <class Interface, class Faulty>
void add_faults(Registry& registry, const std::vector<std::string>& faults) {
  for (const std::string& fault : faults)
    registry.add<Interface, NoSettings>({.name = fault, .summary = "Breaks a promise, or none."},
                                        [fault](const NoSettings&, const CreationContext& context) {
                                          return std::unique_ptr<Interface>(std::make_unique<Faulty>(fault, context));
                                        });
}

/// Kind by kind.
void add_extractors(Registry& registry);
void add_segmenters(Registry& registry);
void add_filters(Registry& registry);
void add_optimizers(Registry& registry);
void add_loop_detectors(Registry& registry);

/// A module of ours, to be made worse.
template <class Interface>
std::unique_ptr<Interface> sound_module(void (*entry)(Registry&), const std::string& name,
                                        const CreationContext& context, const ParameterValues& values = {}) {
  Registry registry;
  entry(registry);
  return registry.create<Interface>(name, values, context);
}

}  // namespace holdfast::bad
