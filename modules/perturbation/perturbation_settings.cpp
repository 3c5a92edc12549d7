// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/perturbation/perturbation_settings.hpp"

namespace holdfast {

std::vector<std::pair<std::string, double>> PerturbationSettings::strengths() const {
  std::vector<std::pair<std::string, double>> found;
  const ParameterTable<PerturbationSettings> table;
  const ParameterValues values = table.values(*this);
  for (const Parameter& parameter : table.parameters())
    if (const auto* strength = std::get_if<double>(&values.at(parameter.name)); strength != nullptr && *strength != 0.0)
      found.emplace_back(parameter.name, *strength);
  return found;
}

}  // namespace holdfast
