// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

/// Common settings of all sources of recordings: range of frames, and handling of unusable ones.
struct RecordedFrames {
  std::string on_bad_frame = "fail";
  std::int64_t start = 0;
  std::int64_t frames = 0;

  bool skips_bad_frames() const { return on_bad_frame == "skip"; }

  /// Adds the rows of these parameters to the table of `Settings`, which derive from this. `frame` names what is
  /// counted: frame or pair.
  template <class Settings>
  static void add_rows(ParameterTable<Settings>& table, const std::string& frame) {
    table
        .add("on_bad_frame", static_cast<std::string Settings::*>(&RecordedFrames::on_bad_frame),
             "reaction to a missing, damaged or unsuitable image: stop with an error, or skip and count the frame")
        .one_of({"fail", "skip"});
    table
        .add("start", static_cast<std::int64_t Settings::*>(&RecordedFrames::start),
             "index of the first " + frame + ", from 0")
        .at_least(0);
    table
        .add("frames", static_cast<std::int64_t Settings::*>(&RecordedFrames::frames),
             "number of " + frame + "s, 0 = all")
        .at_least(0);
  }
};

}  // namespace holdfast
