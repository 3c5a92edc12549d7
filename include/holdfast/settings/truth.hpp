// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace holdfast {

class Segmenter;
template <class Settings>
class ParameterTable;

/// The segmenter `truth`: what each value means, and its range, is in the reference (`holdfast modules truth`).
struct TruthSettings {
  using Interface = Segmenter;
  static constexpr const char* module = "truth";

  std::vector<std::string> classes;

  static void describe(ParameterTable<TruthSettings>& table);
};

}  // namespace holdfast
