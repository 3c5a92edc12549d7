// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/module_check.hpp"

namespace holdfast {

const ModuleEntry* find_module(const Registry& registry, const std::string& kind, const std::string& name,
                               const SourceLocation& place, std::vector<Diagnostic>& diagnostics) {
  const ModuleEntry* entry = registry.find(kind, name);
  if (entry == nullptr)
    diagnostics.push_back(
        {place, "there is no " + kind + " module '" + name + "'; " + registry.suggestion(kind, name)});
  else if (const std::string reason = registry.absence(kind, name); !reason.empty())
    diagnostics.push_back({place, "the " + kind + " module '" + name + "' cannot be used: " + reason});
  return entry;
}

}  // namespace holdfast
