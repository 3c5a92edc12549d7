// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/motion_objects.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void MotionObjectsSettings::describe(ParameterTable<MotionObjectsSettings>& table) {
  using S = MotionObjectsSettings;
  table
      .add("suspicion", &S::suspicion,
           "log-odds that the filters before this one gave to what may move, at most; larger finds more")
      .range(-20, 0);
  table.add("surface", &S::surface, "that an object shows, at least").range(0.001, 10).unit("m^2");
  table
      .add("interval", &S::interval,
           "age of the image that an object is aligned with, at most; longer measures slow movements better")
      .range(0.03, 1)
      .unit("s");
  table.add("speed", &S::speed, "of an object that moves, at least").range(0.01, 10).unit("m/s");
  table.add("moving_time", &S::moving_time, "that something must have moved for before it counts as an object")
      .range(0, 10)
      .unit("s");
  table.add("rest_time", &S::rest_time, "after which an object that stands is static again").range(0, 1000).unit("s");
  table.add("memory", &S::memory, "that an object is kept for while it is hidden").range(0, 60).unit("s");
  table.add("moving_log_odds", &S::moving_log_odds, "said of an object that moves").range(-20, 0);
  table.add("static_log_odds", &S::static_log_odds, "said of an object that came to rest").range(0, 20);
}

}  // namespace holdfast
