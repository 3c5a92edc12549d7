// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace holdfast {

class Observer;
template <class Settings>
class ParameterTable;

/// Settings of the observer `foxglove`. Ranges and units: `holdfast modules foxglove`.
/// Thread: any.
struct FoxgloveSettings {
  using Interface = Observer;
  static constexpr const char* module = "foxglove";

  std::string listen = "127.0.0.1";  ///< numeric address; another one than loopback opens the run to other machines
  int port = 8765;                   ///< 0 = any free port
  std::string token;                 ///< secret part of the address; empty = random digits, new in each run
  bool wait = false;                 ///< whether the first frame waits for a subscription
  int image_every = 1;               ///< an image for every n-th frame; 0 = none
  int quality = 80;                  ///< JPEG quality of images, 1 to 100
  double map_interval = 1.0;         ///< minimum time between two states of the map [s]

  static void describe(ParameterTable<FoxgloveSettings>& table);
};

}  // namespace holdfast
