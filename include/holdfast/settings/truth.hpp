// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace holdfast {

class Segmenter;
template <class Settings>
class ParameterTable;

/// Settings of the segmenter `truth`.
struct TruthSettings {
  using Interface = Segmenter;
  static constexpr const char* module = "truth";

  std::vector<std::string> classes;  ///< classes of the source to segment, all others are background; empty = all
  bool instances = false;            ///< also separate objects of one class, such as several people

  static void describe(ParameterTable<TruthSettings>& table);
};

}  // namespace holdfast
