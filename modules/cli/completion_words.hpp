// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/plugin/registry.hpp"

namespace holdfast {

/// What shells complete beside commands, options and files.
enum class CompletionWords {
  settings,        ///< what follows --set: "features=orb", "run.mode=threaded", "features.orb.count="
  modules,         ///< names of modules and sections, as `holdfast modules` takes them
  configurations,  ///< names of installed configurations
  scenes           ///< names of installed scenes
};

/// Words of a kind, each once. A setting whose values are not known ends with "=".
std::vector<std::string> completion_words(CompletionWords kind, const Registry& registry);

}  // namespace holdfast
