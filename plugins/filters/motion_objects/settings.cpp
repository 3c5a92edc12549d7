// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/settings/motion_objects.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void MotionObjectsSettings::describe(ParameterTable<MotionObjectsSettings>& table) {
  using S = MotionObjectsSettings;
  table
      .add("suspicion", &S::suspicion,
           "log-odds of earlier filters at or below which a block is a motion hypothesis; a larger value finds more")
      .range(-20, 0);
  table.add("surface", &S::surface, "minimum visible surface of an object").range(0.001, 10).unit("m^2");
  table
      .add("interval", &S::interval,
           "maximum age of the frame with which an object is aligned; a longer interval measures slow motion better")
      .range(0.03, 1)
      .unit("s");
  table.add("speed", &S::speed, "minimum speed of a moving object").range(0.01, 10).unit("m/s");
  table.add("moving_time", &S::moving_time, "time that a candidate must have moved before it becomes an object")
      .range(0, 10)
      .unit("s");
  table.add("rest_time", &S::rest_time, "time at rest after which an object counts as static again")
      .range(0, 1000)
      .unit("s");
  table.add("memory", &S::memory, "time that an occluded object is kept").range(0, 60).unit("s");
  table.add("moving_log_odds", &S::moving_log_odds, "evidence of the features on a moving object").range(-20, 0);
  table.add("static_log_odds", &S::static_log_odds, "evidence of the features on an object that came to rest")
      .range(0, 20);
}

}  // namespace holdfast
