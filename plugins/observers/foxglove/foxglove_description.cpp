// SPDX-License-Identifier: BSD-3-Clause
#include "foxglove_description.hpp"

#include "holdfast/plugin/parameter_table.hpp"
#include "holdfast/settings/foxglove.hpp"

namespace holdfast {

void FoxgloveSettings::describe(ParameterTable<FoxgloveSettings>& table) {
  using S = FoxgloveSettings;
  table.add("listen", &S::listen,
            "numeric address to listen at; another one than 127.0.0.1 opens the run to other machines");
  table.add("port", &S::port, "port to listen at; 0 = any free one").range(0, 65535);
  table.add("token", &S::token,
            "secret part of the address, of letters, digits, - and _, not kept in results; 16 or more unless `listen` "
            "is a loopback address; empty = random digits, new in each run");
  table.add("wait", &S::wait, "wait before the first frame until a client has subscribed to topics");
  table
      .add("image_every", &S::image_every,
           "an image and its moving cells are sent for every frame whose index is a multiple of this number; 0 = no "
           "images")
      .range(0, 100000);
  table.add("quality", &S::quality, "JPEG quality of the images").range(1, 100);
  table
      .add("map_interval", &S::map_interval,
           "minimum time between two states of the map (keyframes and points); the last one is always sent")
      .range(0, 1e6)
      .unit("s");
}

ModuleDescription foxglove_plugin::description() {
  return {
      .name = FoxgloveSettings::module,
      .summary = "Sends poses, map, moving objects, images and the state of every frame to Foxglove while it runs."};
}

}  // namespace holdfast
