// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace holdfast {

class Observer;
template <class Settings>
class ParameterTable;

/// Settings of the observer `viewer`. Ranges and units: `holdfast modules viewer`.
/// Thread: any.
struct ViewerSettings {
  using Interface = Observer;
  static constexpr const char* module = "viewer";

  std::string listen = "127.0.0.1";  ///< numeric address; another one than loopback opens the run to other machines
  int port = 0;                      ///< 0 = any free port
  bool wait = false;                 ///< whether the first frame waits for a browser
  double speed = 0.0;                ///< at first; 1 = at the time stamps, 0 = as fast as it goes
  int picture_width = 480;           ///< larger pictures are scaled down [px]
  double picture_rate = 12.0;        ///< most pictures per second

  static void describe(ParameterTable<ViewerSettings>& table);
};

}  // namespace holdfast
