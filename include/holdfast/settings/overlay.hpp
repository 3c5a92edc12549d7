// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace holdfast {

class Observer;
template <class Settings>
class ParameterTable;

/// The observer `overlay`: what each value means, and its range, is in the reference (`holdfast modules overlay`).
/// Thread: any.
struct OverlaySettings {
  using Interface = Observer;
  static constexpr const char* module = "overlay";

  int every = 1;
  std::string format = "jpg";
  std::string layout = "single";
  int quality = 90;

  static void describe(ParameterTable<OverlaySettings>& table);
};

}  // namespace holdfast
