// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

/// The `evidence` section of a configuration: how what filters say becomes weights, and how it is remembered.
struct EvidenceSettings {
  std::string removal = "soft";
  double static_log_odds = 2.0;
  double threshold = 0.5;
  double ignore_below = 0.2;
  double carried_share = 0.95;
  double measured_share = 0.3;
  double limit = 4.0;
  bool skip_moving = true;

  static void describe(ParameterTable<EvidenceSettings>& table) {
    using S = EvidenceSettings;
    table
        .add("removal", &S::removal,
             "soft: features weigh by their probability of standing still; hard: those below the threshold weigh "
             "nothing, all others fully")
        .one_of({"soft", "hard"});
    table.add("static_log_odds", &S::static_log_odds, "log-odds that a feature stands still before anything is known")
        .range(-5, 10);
    table.add("threshold", &S::threshold, "hard removal: features that stand still with less probability weigh nothing")
        .range(0, 1);
    table.add("ignore_below", &S::ignore_below, "soft removal: less probable features weigh nothing").range(0, 1);
    table
        .add("carried_share", &S::carried_share,
             "share of what is known of a map point that lasts until its next sight")
        .range(0, 1);
    table.add("measured_share", &S::measured_share, "share of what a frame measures that its map points keep")
        .range(0, 1);
    table.add("skip_moving", &S::skip_moving,
              "find no features on masked objects that moved in the last frame; all the others lie where they serve");
    table.add("limit", &S::limit, "what is known of a map point never exceeds these log-odds").range(0.1, 100);
  }
};

}  // namespace holdfast
