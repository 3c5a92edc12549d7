// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class Observer;
template <class Settings>
class ParameterTable;

/// Settings of the observer `health`.
/// Thread: any.
struct HealthSettings {
  using Interface = Observer;
  static constexpr const char* module = "health";

  bool truth = true;  ///< whether true poses are written as well, where the source has them

  static void describe(ParameterTable<HealthSettings>& table);
};

}  // namespace holdfast
