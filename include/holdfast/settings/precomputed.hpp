// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "holdfast/plugin/parameter.hpp"

namespace holdfast {

class Segmenter;
template <class Settings>
class ParameterTable;

/// The segmenter `precomputed`: what each value means, and its range, is in the reference (`holdfast modules
/// precomputed`).
struct PrecomputedSettings {
  using Interface = Segmenter;
  static constexpr const char* module = "precomputed";

  std::filesystem::path path;
  std::filesystem::path list;
  double tolerance = 0.0;
  TextMap labels;

  static void describe(ParameterTable<PrecomputedSettings>& table);
};

}  // namespace holdfast
