// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_description.hpp"

#include "holdfast/plugin/parameter_table.hpp"
#include "holdfast/settings/viewer.hpp"

namespace holdfast {

void ViewerSettings::describe(ParameterTable<ViewerSettings>& table) {
  using S = ViewerSettings;
  table.add("listen", &S::listen,
            "numeric address to serve the page at; another one than 127.0.0.1 opens the run to other machines");
  table.add("port", &S::port, "port to serve the page at; 0 = any free one").range(0, 65535);
  table.add("wait", &S::wait, "wait for a browser after the first frame");
  table
      .add("speed", &S::speed,
           "speed of the frames at first, relative to their time stamps; 1 = at the time stamps, 0 = as fast as "
           "possible")
      .range(0.0, 4.0);
  table.add("picture_width", &S::picture_width, "wider pictures are scaled down before they are sent")
      .range(64, 4096)
      .unit("px");
  table.add("picture_rate", &S::picture_rate, "maximum number of pictures per second").range(0.1, 60.0).unit("1/s");
}

ModuleDescription viewer_plugin::description() {
  return {.name = ViewerSettings::module,
          .summary = "Shows the run in a browser while it goes: map, path, picture, objects and times per stage."};
}

}  // namespace holdfast
