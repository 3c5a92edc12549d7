// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/config/run_settings.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void RunSettings::describe(ParameterTable<RunSettings>& table) {
  using S = RunSettings;
  table.add("mode", &S::mode,
            "sequential: one thread for the work of all frames, the same bits on every run; threaded: tracking beside "
            "local mapping, loop closing and segmentation, each in its own thread");
  table.add("seed", &S::seed, "the only source of chance").at_least(0);
  table.add(
      "pace", &S::pace,
      "threaded mode; none: frames as fast as they can be read and tracked; timestamps: as fast as they were taken");
  table.add("late_frames", &S::late_frames,
            "threaded mode, paced; queue: a frame that tracking has no time for waits, and the camera waits with it; "
            "drop: the oldest one that waits is left out, and those that reading is late for");
  table
      .add(
          "prefetch", &S::prefetch,
          "sequential mode: frames that a thread reads ahead, from sources that allow it; results do not depend on it; "
          "0: frames are read when they are needed")
      .range(0, 1000);
  table.add("frame_queue", &S::frame_queue, "threaded mode: frames that wait for tracking, at most").range(1, 1000);
  table
      .add("keyframe_queue", &S::keyframe_queue,
           "threaded mode: keyframes that wait for local mapping, at most; paced, one that finds no room is put off")
      .range(1, 1000);
  table
      .add("minimum_coverage", &S::minimum_coverage,
           "a run that finds poses for a smaller share of its frames gets a warning, and fails with --strict; 0: never")
      .range(0.0, 1.0);
}

std::optional<std::string> RunSettings::contradiction() const {
  if (threaded() || !paced()) return std::nullopt;
  return "found 'timestamps' for 'pace' of section 'run', which sequential mode cannot keep; expected 'none', or "
         "'threaded' for 'mode'";
}

}  // namespace holdfast
