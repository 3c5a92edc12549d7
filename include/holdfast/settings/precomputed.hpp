// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "holdfast/plugin/parameter.hpp"

namespace holdfast {

class Segmenter;
template <class Settings>
class ParameterTable;

/// Settings of the segmenter `precomputed`. Ranges and units: `holdfast modules precomputed`.
struct PrecomputedSettings {
  using Interface = Segmenter;
  static constexpr const char* module = "precomputed";

  std::filesystem::path path;  ///< folder of label images; required
  /// File with lines "timestamp filename"; empty = the name of each PNG is its time stamp.
  std::filesystem::path list;
  double tolerance = 0.0;  ///< maximum time difference between frame and label image [s]; 0 = identical time stamps
  TextMap labels;          ///< class name of each value or range of values; required except with annotations of COCO

  static void describe(ParameterTable<PrecomputedSettings>& table);
};

}  // namespace holdfast
