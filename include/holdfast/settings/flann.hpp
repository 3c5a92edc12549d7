// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class LoopDetector;
template <class Settings>
class ParameterTable;

/// The loop detector `flann`: what each value means, and its range, is in the reference (`holdfast modules flann`).
/// Thread: any.
struct FlannSettings {
  using Interface = LoopDetector;
  static constexpr const char* module = "flann";

  int radius = 32;
  int descriptors = 700;
  int probes = 3;
  int checks = 48;

  static void describe(ParameterTable<FlannSettings>& table);
};

}  // namespace holdfast
