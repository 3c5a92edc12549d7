// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/plugin/registry.hpp"

namespace holdfast {

enum class ReferenceFormat { text, markdown, json };

/// The reference of everything that a configuration can say, made from the parameter tables: one entry per module, by
/// kind and name, and per plain section (camera and run among them). `name` narrows it to the modules and sections, or
/// the kind, of that name; throws Error with the nearest known name when there is none. In text form a reference that
/// is not narrowed lists names and summaries only.
std::string reference(const Registry& registry, const std::vector<SectionDescription>& sections,
                      const std::string& name, ReferenceFormat format);

}  // namespace holdfast
