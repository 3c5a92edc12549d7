// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "holdfast/config/configuration.hpp"

namespace holdfast {

/// Full keys of the parameters of a configuration by their last name, for a parameter that is written in another
/// section than its own.
class ParameterPlaces {
 public:
  /// `root` and `registry` must outlive the object.
  ParameterPlaces(const ConfigurationNode& root, const Registry& registry,
                  const std::vector<SectionDescription>& sections);

  /// At most three keys, such as "source.tum.depth_factor": of the modules that the configuration selects and of plain
  /// sections; if none has such a parameter, of the other modules.
  std::vector<std::string> find(const std::string& name) const;

 private:
  void add_module(const std::string& kind, const std::string& prefix, const ConfigurationNode& node);

  const Registry& registry_;
  std::vector<std::pair<std::string, std::vector<Parameter>>> selected_;  // key of the section or module
};

}  // namespace holdfast
