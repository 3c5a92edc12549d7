// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class Observer;
template <class Settings>
class ParameterTable;

/// The observer `objects`: what each value means, and its range, is in the reference (`holdfast modules objects`).
/// Thread: any.
struct ObjectsSettings {
  using Interface = Observer;
  static constexpr const char* module = "objects";

  bool hidden = false;

  static void describe(ParameterTable<ObjectsSettings>& table);
};

}  // namespace holdfast
