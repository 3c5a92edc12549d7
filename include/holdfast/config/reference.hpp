// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/plugin/registry.hpp"

namespace holdfast {

enum class ReferenceFormat { text, markdown, json };

/// Generates the reference of all modules and plain sections from their parameter tables: one entry per module, by kind
/// and name, and one per plain section (camera and run included). A non-empty `name` selects the modules and sections
/// with this name or kind; throws Error with the nearest known name if there is none. The text form without `name`
/// lists names and summaries only.
std::string reference(const Registry& registry, const std::vector<SectionDescription>& sections,
                      const std::string& name, ReferenceFormat format);

}  // namespace holdfast
