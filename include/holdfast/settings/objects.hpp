// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class Observer;
template <class Settings>
class ParameterTable;

/// Settings of the observer `objects`.
/// Thread: any.
struct ObjectsSettings {
  using Interface = Observer;
  static constexpr const char* module = "objects";

  bool hidden = false;  ///< whether predicted poses of occluded objects are written as well

  static void describe(ParameterTable<ObjectsSettings>& table);
};

}  // namespace holdfast
