// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class Observer;
template <class Settings>
class ParameterTable;

/// Settings of the observer `mcap`. Ranges and units: `holdfast modules mcap`.
/// Thread: any.
struct McapSettings {
  using Interface = Observer;
  static constexpr const char* module = "mcap";

  int image_every = 5;        ///< an image with its mask is written for every n-th frame; 0 = none
  int quality = 80;           ///< JPEG quality of images, 1 to 100
  double map_interval = 1.0;  ///< minimum time between two states of the map [s]

  static void describe(ParameterTable<McapSettings>& table);
};

}  // namespace holdfast
